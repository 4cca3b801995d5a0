#include "tools/inspect/confidence_text.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "relations/confidence.hpp"

namespace isthmus {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

/// Of a point of two dimensions, 95 % lie in the ellipse of so many: what pictures draw.
constexpr double sigmas_of_both_axes = 2.4477;

[[gnu::format(printf, 1, 2)]] std::string print(const char* format, ...) {
  std::array<char, 256> text{};
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text.data(), text.size(), format, arguments);
  va_end(arguments);
  return text.data();
}

void require_one_island(const RelationGraph& graph, PatchId a, PatchId b) {
  for (const PatchId id : {a, b}) {
    if (!id.valid() || static_cast<std::size_t>(id.value) >= graph.patch_count()) {
      throw std::runtime_error("there is no patch " + std::to_string(id.value));
    }
  }
  if (graph.island(a) != graph.island(b)) {
    throw std::runtime_error("patches " + std::to_string(a.value) + " and " + std::to_string(b.value) +
                             " are on different islands");
  }
}

}  // namespace

std::string confidence_text(const RelationGraph& graph, std::span<const Pose> poses, PatchId a, PatchId b) {
  require_one_island(graph, a, b);
  const auto covariances = exact_relative_covariances(graph, poses, a, std::span(&b, 1));
  if (covariances.empty()) {
    throw std::runtime_error("the relations leave the island of patch " + std::to_string(a.value) +
                             " undetermined");
  }
  const Eigen::Matrix3d& c = covariances.front();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> ellipse(c.topLeftCorner<2, 2>());
  const double longer_axis_m = std::sqrt(std::max(0.0, ellipse.eigenvalues()(1)));
  const double yaw_sigma_rad = std::sqrt(c(2, 2));
  const Pose a_from_b =
      ominus(poses[static_cast<std::size_t>(b.value)], poses[static_cast<std::size_t>(a.value)]);

  std::string text =
      print("patch %d relative to patch %d, in the frame of patch %d\n", b.value, a.value, a.value);
  text +=
      print("  pose   x %.4f m, y %.4f m, yaw %.3f deg\n", a_from_b.x, a_from_b.y, degrees * a_from_b.yaw);
  text += print("  sigma  x %.4f m, y %.4f m, yaw %.3f deg\n", std::sqrt(c(0, 0)), std::sqrt(c(1, 1)),
                degrees * yaw_sigma_rad);
  text += print("  95 %%   %.4f m along the longer axis, %.3f deg; both axes at once %.4f m\n",
                1.96 * longer_axis_m, 1.96 * degrees * yaw_sigma_rad, sigmas_of_both_axes * longer_axis_m);
  text += "  covariance (m, rad)\n";
  for (int row = 0; row < 3; ++row)
    text += print("  %12.5e %12.5e %12.5e\n", c(row, 0), c(row, 1), c(row, 2));
  return text;
}

}  // namespace isthmus
