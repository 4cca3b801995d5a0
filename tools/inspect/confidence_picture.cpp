#include "tools/inspect/confidence_picture.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "relations/confidence.hpp"
#include "server/output/format/number.hpp"
#include "server/output/pictures/island_content.hpp"
#include "server/output/pictures/layout.hpp"
#include "server/output/pictures/map_sheet.hpp"
#include "server/output/pictures/marks.hpp"

namespace isthmus {
namespace {

/// More ellipses would hide one another.
constexpr std::size_t max_ellipses = 250;
/// How long the longest half axis is to be, of the map's longer side.
constexpr double shown_share = 0.06;
constexpr double sigmas_of_95_percent = 2.4477;
constexpr double line_em = 0.2;

const Rgb a_colour = way_style(1).colour;
const Rgb b_colour = way_style(0).colour;
const Rgb others_colour = way_style(5).colour;

/// Patch b first, then others of the island at equal steps.
std::vector<PatchId> shown_patches(std::span<const PatchId> patches, PatchId a, PatchId b) {
  std::vector<PatchId> shown = {b};
  const std::size_t step = patches.size() / max_ellipses + 1;
  for (std::size_t i = 0; i < patches.size(); i += step)
    if (patches[i] != a && patches[i] != b) shown.push_back(patches[i]);
  return shown;
}

/// From the frame of a to the island's.
Eigen::Matrix2d in_map(const Eigen::Matrix3d& covariance, const Pose& map_from_a) {
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(map_from_a.yaw).toRotationMatrix();
  return turn * covariance.topLeftCorner<2, 2>() * turn.transpose();
}

double half_axis_m(const Eigen::Matrix2d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
  return sigmas_of_95_percent * std::sqrt(std::max(0.0, axes.eigenvalues()(1)));
}

Pose pose_of(const ConfidenceMap& map, PatchId patch) {
  return map.poses[static_cast<std::size_t>(patch.value)];
}

Legend legend_of(PatchId a, PatchId b, double times) {
  const std::string enlarged = times > 1 ? ", enlarged " + number(times) + " times" : "";
  return {line_entry("patch " + std::to_string(b.value) + ", 95 %" + enlarged,
                     {.colour = b_colour, .width_px = 3}),
          line_entry("other patches, the same", {.colour = others_colour, .width_px = 1.5}),
          {"patch " + std::to_string(a.value) + ", which all is relative to",
           [](Canvas& canvas, const PixelBox& box, double em) {
             canvas.disc({(box.left + box.right) / 2, (box.top + box.bottom) / 2}, 0.45 * em, a_colour);
           }}};
}

void draw(MapSheet& sheet, const ConfidenceMap& map, PatchId a, const std::vector<PatchId>& shown,
          const std::vector<Eigen::Matrix3d>& covariances, double times) {
  Canvas& canvas = sheet.canvas();
  const MapWindow& window = sheet.window();
  const Pose map_from_a = pose_of(map, a);
  canvas.clip(window.box);
  for (std::size_t i = shown.size(); i-- > 0;) {  // b, the first, above all others
    const bool is_b = i == 0;
    const Eigen::Vector2d at = position(pose_of(map, shown[i]));
    draw_ellipse(canvas, window, at, in_map(covariances[i], map_from_a), times,
                 {.colour = is_b ? b_colour : others_colour, .width_px = is_b ? line_em * window.em : 1.5});
    draw_patch(canvas, window, at, is_b ? b_colour : ink::faint);
  }
  canvas.disc(window.pixels(position(map_from_a)), 0.45 * window.em, a_colour);
  Labels labels(window);
  labels.keep_free(position(map_from_a));
  for (const auto& [patch, colour] : {std::pair(a, a_colour), {shown.front(), b_colour}})
    labels.draw(canvas, std::to_string(patch.value), position(pose_of(map, patch)),
                {.size_px = window.em, .colour = colour, .bold = true});
  canvas.unclip();
}

}  // namespace

SheetText confidence_sheet_text(const ConfidenceMap& map, PatchId a, PatchId b,
                                const Eigen::Matrix3d& covariance, double longest_m) {
  SheetText text{"Island " + std::to_string(map.island) + ": patch " + std::to_string(b.value) +
                     " relative to patch " + std::to_string(a.value),
                 "σ " + fixed(std::sqrt(covariance(0, 0)), 4) + " m along x and " +
                     fixed(std::sqrt(covariance(1, 1)), 4) + " m along y of patch " +
                     std::to_string(a.value) + "; the ellipse of 95 % reaches " + fixed(longest_m, 4) + " m"};
  if (const std::string time = time_text(map.from_utime, map.to_utime); !time.empty())
    text.subtitle += "; " + time;
  return text;
}

double enlargement(double longest_m, double map_m) {
  const double wanted = shown_share * map_m / std::max(longest_m, 1e-9);
  return wanted < 1 ? 1 : round_length(wanted);
}

void write_confidence_picture(const ConfidenceMap& map, PatchId a, PatchId b, const std::string& path) {
  const std::vector<PatchId> shown = shown_patches(map.patches, a, b);
  const std::vector<Eigen::Matrix3d> covariances = exact_relative_covariances(map.graph, map.poses, a, shown);
  if (covariances.size() != shown.size())
    throw std::runtime_error("the relations leave the island of patch " + std::to_string(a.value) +
                             " undetermined");
  const auto half_m = [&](const Eigen::Matrix3d& one) { return half_axis_m(in_map(one, pose_of(map, a))); };
  double longest_m = 0;
  for (const Eigen::Matrix3d& one : covariances) longest_m = std::max(longest_m, half_m(one));
  const double times =
      enlargement(longest_m, std::max(map.grid.width, map.grid.height) * map.grid.resolution_m);
  MapSheet sheet(map.grid, confidence_sheet_text(map, a, b, covariances.front(), half_m(covariances.front())),
                 legend_of(a, b, times));
  draw(sheet, map, a, shown, covariances, times);
  sheet.write(path);
}

}  // namespace isthmus
