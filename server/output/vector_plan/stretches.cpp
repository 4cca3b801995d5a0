#include "server/output/vector_plan/stretches.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "server/output/vector_plan/sight_lines.hpp"

namespace isthmus {
namespace {

/// A segment along the wall's line.
struct Piece {
  double from_m = 0;
  double to_m = 0;
  bool from_known = false;
  bool to_known = false;
  int view = 0;
};

std::vector<Piece> pieces_of(const FittedWall& wall, std::span<const FeatureSeen> segments) {
  std::vector<Piece> pieces;
  for (const std::size_t i : wall.segments) {
    const Feature& feature = segments[i].observed.feature;
    pieces.push_back({wall.line.along_m(feature.a), wall.line.along_m(feature.b), feature.end_a_known,
                      feature.end_b_known, segments[i].view});
  }
  return pieces;
}

enum class Bin { unknown, wall, open };

class Bins {
 public:
  Bins(const FittedWall& wall, std::span<const Piece> pieces, std::span<const int> passes,
       const StretchOptions& options)
      : start_m_(-wall.line.half_m), width_m_(options.bin_m), bins_(bin_count(wall.line, options)) {
    const std::vector<Seen> seen = count_views(pieces, options.lone_m);
    for (std::size_t k = 0; k < bins_.size(); ++k) {
      const int passed = passes.empty() ? 0 : passes[k];
      const bool enough = seen[k].views >= options.min_views || seen[k].in_long_piece;
      if (enough && seen[k].views >= passed)
        bins_[k] = Bin::wall;
      else if (passed >= options.min_views || passed > seen[k].views)
        bins_[k] = Bin::open;
    }
  }

  /// Runs of wall, short gaps without an open bin between them closed.
  std::vector<Stretch> walls(double close_gap_m) const {
    std::vector<Stretch> runs;
    for (std::size_t k = 0; k < bins_.size(); ++k) {
      if (bins_[k] != Bin::wall) continue;
      const double from = edge_m(k), to = edge_m(k + 1);
      const bool hidden = !runs.empty() && from - runs.back().to_m <= close_gap_m + 1e-9 &&
                          open_share(runs.back().to_m, from) == 0;
      if (hidden || (!runs.empty() && from - runs.back().to_m < 1e-9))
        runs.back().to_m = to;
      else
        runs.push_back({from, to});
    }
    return runs;
  }

  /// How far from a place on the line the next open bin or wall is, to one side; at most `max_m`.
  double room_m(double from_m, int side, double max_m) const {
    for (std::size_t k = 0; k < bins_.size(); ++k) {
      const std::size_t bin = side > 0 ? k : bins_.size() - 1 - k;
      const double near = side > 0 ? edge_m(bin) - from_m : from_m - edge_m(bin + 1);
      if (near > -1e-6 && bins_[bin] != Bin::unknown) return std::clamp(near, 0.0, max_m);
    }
    return max_m;
  }

  /// How much of a part of the line beams went through.
  double open_share(double from_m, double to_m) const {
    int open = 0, all = 0;
    for (std::size_t k = 0; k < bins_.size(); ++k) {
      const double middle = 0.5 * (edge_m(k) + edge_m(k + 1));
      if (middle < from_m || middle > to_m) continue;
      ++all;
      open += bins_[k] == Bin::open ? 1 : 0;
    }
    return all == 0 ? 0 : static_cast<double>(open) / all;
  }

 private:
  double edge_m(std::size_t k) const { return start_m_ + static_cast<double>(k) * width_m_; }

  struct Seen {
    int views = 0;
    int last_view = -1;
    bool in_long_piece = false;
  };

  std::vector<Seen> count_views(std::span<const Piece> pieces, double long_m) const {
    std::vector<Seen> seen(bins_.size());
    for (const Piece& piece : pieces) {
      const double from = std::round((piece.from_m - start_m_) / width_m_);
      const double to = std::round((piece.to_m - start_m_) / width_m_);
      for (double k = std::max(from, 0.0); k < to && k < static_cast<double>(bins_.size()); ++k) {
        Seen& bin = seen[static_cast<std::size_t>(k)];
        bin.views += bin.last_view != piece.view ? 1 : 0;
        bin.last_view = piece.view;
        bin.in_long_piece |= piece.to_m - piece.from_m >= long_m;
      }
    }
    return seen;
  }

  double start_m_ = 0;
  double width_m_ = 0;
  std::vector<Bin> bins_;
};

/// Where an end is that lies near `about_m`: the median of those that were found to be real, else the second
/// farthest that was seen, else where it was.
double end_near(double about_m, int side, std::span<const Piece> pieces, double reach_m) {
  std::vector<double> known, seen;
  for (const Piece& piece : pieces) {
    const double end = side < 0 ? piece.from_m : piece.to_m;
    if (std::abs(end - about_m) > reach_m) continue;
    seen.push_back(end);
    if (side < 0 ? piece.from_known : piece.to_known) known.push_back(end);
  }
  std::sort(known.begin(), known.end());
  if (!known.empty()) return known[known.size() / 2];
  std::sort(seen.begin(), seen.end());
  if (seen.empty()) return about_m;
  if (seen.size() == 1) return seen.front();
  return side < 0 ? seen[1] : seen[seen.size() - 2];
}

bool known_near(double about_m, int side, std::span<const Piece> pieces, double reach_m) {
  return std::any_of(pieces.begin(), pieces.end(), [&](const Piece& piece) {
    const double end = side < 0 ? piece.from_m : piece.to_m;
    return (side < 0 ? piece.from_known : piece.to_known) && std::abs(end - about_m) <= reach_m;
  });
}

int views_of(const Stretch& stretch, std::span<const Piece> pieces) {
  std::set<int> views;
  for (const Piece& piece : pieces)
    if (piece.to_m > stretch.from_m && piece.from_m < stretch.to_m) views.insert(piece.view);
  return static_cast<int>(views.size());
}

}  // namespace

Stretches stretches_of(const FittedWall& wall, std::span<const FeatureSeen> segments,
                       std::span<const int> passes, const StretchOptions& options) {
  const std::vector<Piece> pieces = pieces_of(wall, segments);
  const Bins bins(wall, pieces, passes, options);
  Stretches result;
  for (Stretch run : bins.walls(options.close_gap_m)) {
    const Stretch seen = run;
    run.from_m = end_near(seen.from_m, -1, pieces, options.end_reach_m);
    run.to_m = end_near(seen.to_m, 1, pieces, options.end_reach_m);
    run.views = views_of(run, pieces);
    run.room_before_m =
        std::max(0.0, bins.room_m(seen.from_m, -1, options.corner_reach_m) + run.from_m - seen.from_m);
    run.room_after_m =
        std::max(0.0, bins.room_m(seen.to_m, 1, options.corner_reach_m) + seen.to_m - run.to_m);
    if (run.to_m - run.from_m >= options.min_wall_m) result.walls.push_back(run);
  }
  for (std::size_t k = 1; k < result.walls.size(); ++k) {
    const double from = result.walls[k - 1].to_m, to = result.walls[k].from_m;
    if (to - from < options.min_opening_m || to - from > options.max_opening_m) continue;
    const bool open = passes.empty() ? known_near(from, 1, pieces, options.end_reach_m) &&
                                           known_near(to, -1, pieces, options.end_reach_m)
                                     : bins.open_share(from, to) > 0.5;
    if (open) result.openings.push_back({from, to});
  }
  return result;
}

}  // namespace isthmus
