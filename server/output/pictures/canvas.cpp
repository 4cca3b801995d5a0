#include "server/output/pictures/canvas.hpp"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "server/output/format/atomic_file.hpp"

namespace isthmus {
namespace {

/// Cairo's largest surface.
constexpr int max_side = 32767;
constexpr double halo_share = 0.28;  ///< of a text's size
constexpr double halo_opacity = 0.8;

void check(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS)
    throw std::runtime_error(std::string("a picture cannot be drawn: ") + cairo_status_to_string(status));
}

void set_colour(cairo_t* cairo, Rgb colour, double opacity) {
  cairo_set_source_rgba(cairo, colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0, opacity);
}

void set_pen(cairo_t* cairo, const Pen& pen) {
  set_colour(cairo, pen.colour, pen.opacity);
  cairo_set_line_width(cairo, pen.width_px);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(cairo, pen.dashes.empty() ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
  std::vector<double> dashes_px = pen.dashes;
  for (double& dash : dashes_px) dash *= pen.width_px;
  cairo_set_dash(cairo, dashes_px.data(), static_cast<int>(dashes_px.size()), pen.dashes_from_px);
}

/// Hinting would make letters depend on where they stand.
void set_font(cairo_t* cairo, const Font& font) {
  cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL,
                         font.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, font.size_px);
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cairo, options);
  cairo_font_options_destroy(options);
}

/// How many bytes of UTF-8 follow the first one; nothing it could begin: -1.
int bytes_after(unsigned char first) {
  if (first < 0x80) return 0;
  if (first >= 0xC2 && first < 0xE0) return 1;
  if (first >= 0xE0 && first < 0xF0) return 2;
  return -1;  // nothing beyond the first plane is in the fonts
}

/// Cairo takes nothing else.
std::string as_utf8(const std::string& text) {
  std::string valid;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto first = static_cast<unsigned char>(text[i]);
    const int after = bytes_after(first);
    bool whole = after >= 0 && i + static_cast<std::size_t>(after) < text.size() && first >= 0x20;
    for (int k = 1; whole && k <= after; ++k)
      whole = (static_cast<unsigned char>(text[i + static_cast<std::size_t>(k)]) & 0xC0) == 0x80;
    if (whole && after == 2) {  // overlong forms, surrogates
      const auto second = static_cast<unsigned char>(text[i + 1]);
      whole = !(first == 0xE0 && second < 0xA0) && !(first == 0xED && second >= 0xA0);
    }
    valid += whole ? text.substr(i, static_cast<std::size_t>(after) + 1) : "?";
    if (whole) i += static_cast<std::size_t>(after);
  }
  return valid;
}

/// From the anchor to the left end of the text's base line.
Eigen::Vector2d to_base_line(cairo_t* cairo, const std::string& text, const TextAnchor& anchor) {
  cairo_text_extents_t extents;
  cairo_font_extents_t font;
  cairo_text_extents(cairo, text.c_str(), &extents);
  cairo_font_extents(cairo, &font);
  return {-anchor.across * extents.x_advance, font.ascent - anchor.down * (font.ascent + font.descent)};
}

cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

void trace(cairo_t* cairo, std::span<const Eigen::Vector2d> points) {
  cairo_new_path(cairo);
  for (const Eigen::Vector2d& point : points) cairo_line_to(cairo, point.x(), point.y());
}

}  // namespace

struct Canvas::State {
  State(int width, int height)
      : surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)),
        cairo(cairo_create(surface)) {}
  ~State() {
    cairo_destroy(cairo);
    cairo_surface_destroy(surface);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  cairo_surface_t* surface;
  cairo_t* cairo;
};

Canvas::Canvas(int width, int height)
    : state_(std::make_unique<State>(std::clamp(width, 1, max_side), std::clamp(height, 1, max_side))) {
  fill({0, 0, static_cast<double>(width), static_cast<double>(height)}, ink::paper);
}
Canvas::~Canvas() = default;
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;

int Canvas::width() const { return cairo_image_surface_get_width(state_->surface); }
int Canvas::height() const { return cairo_image_surface_get_height(state_->surface); }

void Canvas::fill(const PixelBox& box, Rgb colour, double opacity) {
  set_colour(state_->cairo, colour, opacity);
  cairo_new_path(state_->cairo);
  cairo_rectangle(state_->cairo, box.left, box.top, box.width(), box.height());
  cairo_fill(state_->cairo);
}

void Canvas::frame(const PixelBox& box, const Pen& pen) {
  set_pen(state_->cairo, pen);
  cairo_new_path(state_->cairo);
  cairo_rectangle(state_->cairo, box.left, box.top, box.width(), box.height());
  cairo_stroke(state_->cairo);
}

void Canvas::line(std::span<const Eigen::Vector2d> points, const Pen& pen) {
  set_pen(state_->cairo, pen);
  trace(state_->cairo, points);
  cairo_stroke(state_->cairo);
}

void Canvas::polygon(std::span<const Eigen::Vector2d> corners, Rgb colour, double opacity) {
  set_colour(state_->cairo, colour, opacity);
  trace(state_->cairo, corners);
  cairo_fill(state_->cairo);
}

void Canvas::disc(const Eigen::Vector2d& centre, double radius_px, Rgb colour) {
  set_colour(state_->cairo, colour, 1);
  cairo_new_path(state_->cairo);
  cairo_arc(state_->cairo, centre.x(), centre.y(), radius_px, 0, 2 * std::numbers::pi);
  cairo_fill(state_->cairo);
}

void Canvas::circle(const Eigen::Vector2d& centre, double radius_px, const Pen& pen) {
  set_pen(state_->cairo, pen);
  cairo_new_path(state_->cairo);
  cairo_arc(state_->cairo, centre.x(), centre.y(), radius_px, 0, 2 * std::numbers::pi);
  cairo_stroke(state_->cairo);
}

void Canvas::image(const Image& image, const Eigen::Vector2d& left_top, double pixels_each) {
  cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height);
  if (cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS && !image.pixels.empty()) {
    unsigned char* bytes = cairo_image_surface_get_data(surface);
    const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface));
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
      const Rgb& p = image.pixels[i];
      const auto width = static_cast<std::size_t>(image.width);
      const std::uint32_t word = static_cast<std::uint32_t>(p.red) << 16 |
                                 static_cast<std::uint32_t>(p.green) << 8 | std::uint32_t{p.blue};
      std::memcpy(bytes + i / width * stride + i % width * sizeof word, &word, sizeof word);
    }
    cairo_surface_mark_dirty(surface);
  }
  cairo_t* cairo = state_->cairo;
  cairo_save(cairo);
  cairo_translate(cairo, left_top.x(), left_top.y());
  cairo_scale(cairo, pixels_each, pixels_each);
  cairo_set_source_surface(cairo, surface, 0, 0);
  cairo_pattern_set_filter(cairo_get_source(cairo),
                           pixels_each >= 1 ? CAIRO_FILTER_NEAREST : CAIRO_FILTER_GOOD);
  cairo_rectangle(cairo, 0, 0, image.width, image.height);
  cairo_fill(cairo);
  cairo_restore(cairo);
  cairo_surface_destroy(surface);
}

void Canvas::text(const std::string& text, const Eigen::Vector2d& at, const TextAnchor& anchor,
                  const Font& font) {
  const std::string shown = as_utf8(text);
  set_font(state_->cairo, font);
  const Eigen::Vector2d base = at + to_base_line(state_->cairo, shown, anchor);
  set_colour(state_->cairo, font.colour, 1);
  cairo_move_to(state_->cairo, base.x(), base.y());
  cairo_show_text(state_->cairo, shown.c_str());
}

void Canvas::text_upwards(const std::string& text, const Eigen::Vector2d& at, const TextAnchor& anchor,
                          const Font& font) {
  cairo_save(state_->cairo);
  cairo_translate(state_->cairo, at.x(), at.y());
  cairo_rotate(state_->cairo, -std::numbers::pi / 2);
  this->text(text, Eigen::Vector2d::Zero(), anchor, font);
  cairo_restore(state_->cairo);
}

void Canvas::text_on_map(const std::string& text, const Eigen::Vector2d& at, const TextAnchor& anchor,
                         const Font& font) {
  const std::string shown = as_utf8(text);
  set_font(state_->cairo, font);
  const Eigen::Vector2d base = at + to_base_line(state_->cairo, shown, anchor);
  cairo_new_path(state_->cairo);
  cairo_move_to(state_->cairo, base.x(), base.y());
  cairo_text_path(state_->cairo, shown.c_str());
  set_pen(state_->cairo,
          {.colour = ink::paper, .width_px = halo_share * font.size_px, .opacity = halo_opacity});
  cairo_stroke(state_->cairo);
  this->text(text, at, anchor, font);
}

Eigen::Vector2d Canvas::size_of(const std::string& text, const Font& font) {
  State state(1, 1);
  set_font(state.cairo, font);
  cairo_text_extents_t extents;
  cairo_font_extents_t line;
  cairo_text_extents(state.cairo, as_utf8(text).c_str(), &extents);
  cairo_font_extents(state.cairo, &line);
  return {extents.x_advance, line.ascent + line.descent};
}

void Canvas::clip(const PixelBox& box) {
  cairo_save(state_->cairo);
  cairo_new_path(state_->cairo);
  cairo_rectangle(state_->cairo, box.left, box.top, box.width(), box.height());
  cairo_clip(state_->cairo);
}

void Canvas::unclip() { cairo_restore(state_->cairo); }

Rgb Canvas::pixel(int column, int row) const {
  cairo_surface_flush(state_->surface);
  const unsigned char* bytes = cairo_image_surface_get_data(state_->surface);
  std::uint32_t word = 0;
  std::memcpy(&word, bytes + row * cairo_image_surface_get_stride(state_->surface) + column * 4, sizeof word);
  return {static_cast<std::uint8_t>(word >> 16), static_cast<std::uint8_t>(word >> 8),
          static_cast<std::uint8_t>(word)};
}

std::string Canvas::png() const {
  check(cairo_status(state_->cairo));
  std::string bytes;
  check(cairo_surface_write_to_png_stream(state_->surface, append, &bytes));
  return bytes;
}

void Canvas::write(const std::string& path) const {
  AtomicFile file(path);
  file.write(png());
  file.commit();
}

}  // namespace isthmus
