#include "server/output/pictures/legend.hpp"

#include <algorithm>
#include <array>

#include "server/output/format/number.hpp"
#include "server/output/pictures/layout.hpp"
#include "server/output/pictures/marks.hpp"

namespace isthmus {
namespace {

constexpr double mark_em = 2.6;  ///< width of an entry's mark
constexpr double gap_em = 0.6;
constexpr double bar_share = 0.25;  ///< of the map's width, at most
constexpr double bar_thickness_em = 0.16;
constexpr double bar_tick_em = 0.5;

std::string metres(double length_m) { return number(length_m) + " m"; }

}  // namespace

double legend_width(const Legend& legend, double em) {
  double widest = 0;
  for (const LegendEntry& entry : legend) {
    const double text = Canvas::size_of(entry.text, {.size_px = em}).x();
    widest = std::max(widest, text + (entry.draw ? (mark_em + gap_em) * em : 0));
  }
  return widest;
}

void draw_legend(Canvas& canvas, const Legend& legend, const std::vector<PixelBox>& boxes, double em) {
  for (std::size_t i = 0; i < legend.size() && i < boxes.size(); ++i) {
    const PixelBox& box = boxes[i];
    const double middle = (box.top + box.bottom) / 2;
    if (!legend[i].draw) {
      canvas.text(legend[i].text, {box.left, middle}, {0, 0.5}, {.size_px = em, .colour = ink::faint});
      continue;
    }
    legend[i].draw(canvas, {box.left, box.top, box.left + mark_em * em, box.bottom}, em);
    canvas.text(legend[i].text, {box.left + (mark_em + gap_em) * em, middle}, {0, 0.5}, {.size_px = em});
  }
}

LegendEntry way_entry(const std::string& name, const WayStyle& style) {
  return line_entry(name, {.colour = style.colour, .width_px = 0, .dashes = style.dashes});
}

LegendEntry line_entry(const std::string& text, const Pen& pen) {
  return {
      text, [pen](Canvas& canvas, const PixelBox& box, double em) {
        const double middle = (box.top + box.bottom) / 2;
        Pen drawn = pen;
        if (drawn.width_px <= 0) drawn.width_px = legend_line_px(em);
        canvas.line(std::array{Eigen::Vector2d(box.left, middle), Eigen::Vector2d(box.right, middle)}, drawn);
      }};
}

LegendEntry note_entry(const std::string& text) { return {text, {}}; }

double scale_bar_length_m(double map_width_px, double pixels_per_m) {
  return round_length(bar_share * map_width_px / pixels_per_m);
}

double scale_bar_width(double length_m, double pixels_per_m, double em) {
  return length_m * pixels_per_m + gap_em * em + Canvas::size_of(metres(length_m), {.size_px = em}).x();
}

void draw_scale_bar(Canvas& canvas, const PixelBox& box, double length_m, double pixels_per_m, double em) {
  const double thickness = std::max(2.0, bar_thickness_em * em), tick = bar_tick_em * em;
  const double middle = (box.top + box.bottom) / 2;
  const double left = box.left, right = box.left + length_m * pixels_per_m;
  canvas.fill({left, middle - thickness / 2, right, middle + thickness / 2}, ink::text);
  canvas.fill({left, middle - tick, left + thickness, middle + tick}, ink::text);
  canvas.fill({right - thickness, middle - tick, right, middle + tick}, ink::text);
  canvas.text(metres(length_m), {right + gap_em * em, middle}, {0, 0.5}, {.size_px = em});
}

}  // namespace isthmus
