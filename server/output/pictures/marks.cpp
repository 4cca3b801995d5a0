#include "server/output/pictures/marks.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace isthmus {
namespace {

/// Of the height of a line of text.
constexpr double way_em = 0.13;
constexpr double legend_line_em = 0.2;
constexpr double start_radius_em = 0.7;
constexpr double look_em = 1.3;
constexpr double end_em = 0.8;
constexpr double patch_radius_em = 0.2;
constexpr double tag_em = 0.5;
constexpr double closure_em = 0.11;
constexpr double closure_end_em = 0.2;
constexpr double closure_halo = 2.5;  ///< of its width
/// So many closed loops are drawn in full; of more each is fainter.
constexpr double loops_in_full = 30;
constexpr double least_opacity = 0.22;
constexpr double faint_width = 0.7;  ///< of the width of one in full
constexpr double arc_height = 0.08;  ///< of its length
constexpr int arc_parts = 24;
constexpr double halo_em = 0.16;
constexpr double label_gap_em = 0.55;
constexpr double kept_free_em = 0.75;

/// √χ² of 2 degrees of freedom at 95 %.
constexpr double sigmas_of_95_percent = 2.4477;
constexpr int ellipse_corners = 72;

Eigen::Vector2d direction(double yaw_rad) { return {std::cos(yaw_rad), -std::sin(yaw_rad)}; }

void start(Canvas& canvas, const Eigen::Vector2d& at, double yaw_rad, Rgb colour, double em) {
  const std::array look = {at, Eigen::Vector2d(at + look_em * em * direction(yaw_rad))};
  canvas.line(look, {.colour = ink::paper, .width_px = (legend_line_em + 2 * halo_em) * em});
  canvas.disc(at, (start_radius_em + halo_em) * em, ink::paper);
  canvas.line(look, {.colour = colour, .width_px = legend_line_em * em});
  canvas.disc(at, start_radius_em * em, ink::paper);
  canvas.circle(at, start_radius_em * em, {.colour = colour, .width_px = legend_line_em * em});
}

void end(Canvas& canvas, const Eigen::Vector2d& at, double yaw_rad, Rgb colour, double em) {
  const Eigen::Vector2d ahead = direction(yaw_rad), left(ahead.y(), -ahead.x());
  const auto corners = [&](double size) {
    return std::array<Eigen::Vector2d, 4>{at + size * ahead, at + size * (-0.7 * ahead + 0.7 * left),
                                          at - 0.35 * size * ahead, at + size * (-0.7 * ahead - 0.7 * left)};
  };
  canvas.polygon(corners((end_em + 2 * halo_em) * em), ink::paper);
  canvas.polygon(corners(end_em * em), colour);
}

void tag(Canvas& canvas, const Eigen::Vector2d& at, double em) {
  const auto corners = [&](double size) {
    return std::array<Eigen::Vector2d, 4>{at + Eigen::Vector2d(size, 0), at + Eigen::Vector2d(0, size),
                                          at - Eigen::Vector2d(size, 0), at - Eigen::Vector2d(0, size)};
  };
  canvas.polygon(corners((tag_em + halo_em) * em), ink::paper);
  canvas.polygon(corners(tag_em * em), ink::tag);
  canvas.polygon(corners(0.4 * tag_em * em), {240, 228, 66});
}

bool is_in_full(const ClosureStyle& style) { return style.opacity >= 1; }

Pen closure_pen(const ClosureStyle& style, double em) {
  if (style.is_merge) return {.colour = ink::closure, .width_px = 2 * closure_em * em};
  const double width = (is_in_full(style) ? 1 : faint_width) * closure_em * em;
  return {.colour = ink::closure, .width_px = width, .dashes = {4, 3}, .opacity = style.opacity};
}

Eigen::Vector2d middle(const PixelBox& box) {
  return {(box.left + box.right) / 2, (box.top + box.bottom) / 2};
}

}  // namespace

double way_line_px(double em) { return std::max(1.5, way_em * em); }
double legend_line_px(double em) { return std::max(2.0, legend_line_em * em); }

void draw_start(Canvas& canvas, const MapWindow& window, const Pose& map_from_robot, const WayStyle& style) {
  start(canvas, window.pixels(position(map_from_robot)), map_from_robot.yaw, style.colour, window.em);
}

void draw_end(Canvas& canvas, const MapWindow& window, const Pose& map_from_robot, const WayStyle& style) {
  end(canvas, window.pixels(position(map_from_robot)), map_from_robot.yaw, style.colour, window.em);
}

void draw_patch(Canvas& canvas, const MapWindow& window, const Eigen::Vector2d& map_point, Rgb colour) {
  canvas.disc(window.pixels(map_point), patch_radius_em * window.em, colour);
}

void draw_tag(Canvas& canvas, const MapWindow& window, const Eigen::Vector2d& map_point) {
  tag(canvas, window.pixels(map_point), window.em);
}

ClosureStyle loop_style(std::size_t loops) {
  return {false, std::clamp(loops_in_full / static_cast<double>(std::max<std::size_t>(loops, 1)),
                            least_opacity, 1.0)};
}

void draw_closure(Canvas& canvas, const MapWindow& window, const Eigen::Vector2d& map_from,
                  const Eigen::Vector2d& map_to, const ClosureStyle& style) {
  const Eigen::Vector2d from = window.pixels(map_from), to = window.pixels(map_to), half = (to - from) / 2;
  const Eigen::Vector2d aside(half.y(), -half.x());
  std::vector<Eigen::Vector2d> arc;
  for (int i = 0; i <= arc_parts; ++i) {
    const double t = 2.0 * i / arc_parts - 1;  // -1 to 1
    arc.push_back(from + half + t * half + 2 * arc_height * (1 - t * t) * aside);
  }
  const Pen pen = closure_pen(style, window.em);
  if (!is_in_full(style)) return canvas.line(arc, pen);
  canvas.line(arc, {.colour = ink::paper, .width_px = closure_halo * pen.width_px, .opacity = 0.7});
  canvas.line(arc, pen);
  for (const Eigen::Vector2d& end : {from, to}) canvas.disc(end, closure_end_em * window.em, ink::closure);
}

Eigen::Vector2d closure_middle(const Eigen::Vector2d& map_from, const Eigen::Vector2d& map_to) {
  const Eigen::Vector2d half = (map_to - map_from) / 2;
  return map_from + half + 2 * arc_height * Eigen::Vector2d(-half.y(), half.x());
}

void draw_ellipse(Canvas& canvas, const MapWindow& window, const Eigen::Vector2d& map_point,
                  const Eigen::Matrix2d& covariance, double times, const Pen& pen) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(covariance);
  const Eigen::Vector2d half_m = times * sigmas_of_95_percent * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i <= ellipse_corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / ellipse_corners;
    const Eigen::Vector2d on_axes(half_m.x() * std::cos(angle), half_m.y() * std::sin(angle));
    corners.push_back(window.pixels(map_point + axes.eigenvectors() * on_axes));
  }
  canvas.line(corners, pen);
}

LegendEntry start_entry() {
  return {"start and heading", [](Canvas& canvas, const PixelBox& box, double em) {
            start(canvas, {box.left + 0.9 * em, middle(box).y()}, 0, ink::faint, em);
          }};
}
LegendEntry end_entry() {
  return {"end and heading", [](Canvas& canvas, const PixelBox& box, double em) {
            end(canvas, middle(box), 0, ink::faint, em);
          }};
}
LegendEntry patch_entry() {
  return {"patch", [](Canvas& canvas, const PixelBox& box, double em) {
            canvas.disc(middle(box), patch_radius_em * em, ink::faint);
          }};
}
LegendEntry tag_entry() {
  return {"tag with its barcode",
          [](Canvas& canvas, const PixelBox& box, double em) { tag(canvas, middle(box), em); }};
}
LegendEntry closure_entry(const ClosureStyle& style, bool named) {
  const std::string what = style.is_merge ? "merge" : "closed loop";
  return {named ? what + " with its id" : what, [style](Canvas& canvas, const PixelBox& box, double em) {
            const double y = middle(box).y();
            canvas.line(std::array{Eigen::Vector2d(box.left, y), Eigen::Vector2d(box.right, y)},
                        closure_pen(style, em));
          }};
}

void Labels::keep_free(const Eigen::Vector2d& map_point) {
  const Eigen::Vector2d at = window_.pixels(map_point);
  const double reach = kept_free_em * window_.em;
  taken_.push_back({at.x() - reach, at.y() - reach, at.x() + reach, at.y() + reach});
}

void Labels::draw(Canvas& canvas, const std::string& text, const Eigen::Vector2d& map_point,
                  const Font& font) {
  const Eigen::Vector2d at = window_.pixels(map_point), size = Canvas::size_of(text, font);
  const double gap = label_gap_em * window_.em;
  const auto box_at = [&](const TextAnchor& anchor, const Eigen::Vector2d& place) {
    const Eigen::Vector2d from = place - Eigen::Vector2d(anchor.across * size.x(), anchor.down * size.y());
    return PixelBox{from.x(), from.y(), from.x() + size.x(), from.y() + size.y()};
  };
  for (const double far : {1.0, 2.0, 3.5, 5.5}) {
    for (const auto& [x, y] : std::array<std::pair<int, int>, 8>{
             {{1, 0}, {-1, 0}, {0, -1}, {0, 1}, {1, -1}, {-1, -1}, {1, 1}, {-1, 1}}}) {
      const TextAnchor anchor{0.5 - 0.5 * x, 0.5 - 0.5 * y};
      const Eigen::Vector2d place = at + far * gap * Eigen::Vector2d(x, y);
      const PixelBox box = box_at(anchor, place);
      const bool inside =
          window_.box.contains({box.left, box.top}) && window_.box.contains({box.right, box.bottom});
      const bool free = std::ranges::none_of(taken_, [&](const PixelBox& one) { return one.overlaps(box); });
      if (!inside || !free) continue;
      taken_.push_back(box);
      canvas.text_on_map(text, place, anchor, font);
      return;
    }
  }
}

}  // namespace isthmus
