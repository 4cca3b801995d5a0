#include "server/engine/map/contradiction.hpp"

#include <algorithm>

namespace isthmus {
namespace {

// How many of a's hits b sees at all, and how many of them where it looked far through.
struct Seen {
  int in_view = 0;
  int deep = 0;
};

Seen seen_through(const Patch& a, const Patch& b, const Pose& b_from_a, const ContradictionOptions& options) {
  Seen seen;
  const std::size_t stride = std::max<std::size_t>(1, a.points.size() / options.points);
  for (std::size_t i = 0; i < a.points.size(); i += stride) {
    const double depth = b.star.depth_m(b_from_a * a.points[i].position);
    if (depth < -options.deep_m) continue;  // hidden from b, or outside its view
    ++seen.in_view;
    if (depth > options.deep_m) ++seen.deep;
  }
  return seen;
}

}  // namespace

std::optional<double> contradiction(const Patch& a, const Patch& b, const Pose& a_from_b,
                                    const ContradictionOptions& options) {
  const Seen of_a = seen_through(a, b, inverse(a_from_b), options);
  const Seen of_b = seen_through(b, a, a_from_b, options);
  const int in_view = of_a.in_view + of_b.in_view;
  if (in_view < options.min_in_view) return std::nullopt;
  return static_cast<double>(of_a.deep + of_b.deep) / in_view;
}

void MeanContradiction::add(const Patch& a, const Patch& b, const Pose& a_from_b) {
  const std::optional<double> share = contradiction(a, b, a_from_b, options_);
  if (!share) return;
  sum_ += *share;
  ++pairs_;
}

void MeanContradiction::add(const Manifold& manifold, PatchId a, PatchId b) {
  add(manifold.patch(a), manifold.patch(b), manifold.relative_pose(a, b));
}

void ContradictionByPatch::add(PatchId patch, std::span<const PatchId> others) {
  MeanContradiction of_patch(options_);
  for (const PatchId other : others) of_patch.add(manifold_, patch, other);
  if (of_patch.pairs() == 0) return;
  pairs_ += of_patch.pairs();
  sum_ += of_patch.mean();
  ++patches_;
}

}  // namespace isthmus
