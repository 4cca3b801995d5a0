#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/output/pictures/colours.hpp"

namespace isthmus {

/// A rectangle of a picture, in pixels: x to the right, y down.
struct PixelBox {
  double left = 0;
  double top = 0;
  double right = 0;
  double bottom = 0;

  double width() const { return right - left; }
  double height() const { return bottom - top; }
  bool contains(const Eigen::Vector2d& point) const {
    return point.x() >= left && point.x() <= right && point.y() >= top && point.y() <= bottom;
  }
  bool overlaps(const PixelBox& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
};

/// Pixels row by row from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;
};

struct Pen {
  Rgb colour{};
  double width_px = 1;
  std::vector<double> dashes{};  ///< lengths in widths of the line; none: unbroken
  double dashes_from_px = 0;     ///< where on its way along the dashes a line begins
  double opacity = 1;
};

struct Font {
  double size_px = 14;
  Rgb colour = ink::text;
  bool bold = false;
};

/// The point of a text that stands where it is put: across from left to right, down from top to bottom (0,
/// 0.5 and 1 are the usual ones).
struct TextAnchor {
  double across = 0;
  double down = 0;
};

/// A picture that is drawn by Cairo. Drawing never fails; what went wrong is an error of `png`. What is drawn
/// depends on nothing but the calls and the fonts that are installed.
class Canvas {
 public:
  Canvas(int width, int height);
  ~Canvas();
  Canvas(Canvas&&) noexcept;
  Canvas& operator=(Canvas&&) noexcept;

  int width() const;
  int height() const;

  void fill(const PixelBox& box, Rgb colour, double opacity = 1);
  void frame(const PixelBox& box, const Pen& pen);
  void line(std::span<const Eigen::Vector2d> points, const Pen& pen);
  void polygon(std::span<const Eigen::Vector2d> corners, Rgb colour, double opacity = 1);
  void disc(const Eigen::Vector2d& centre, double radius_px, Rgb colour);
  void circle(const Eigen::Vector2d& centre, double radius_px, const Pen& pen);
  /// Each pixel of the image as a square of `pixels_each`.
  void image(const Image& image, const Eigen::Vector2d& left_top, double pixels_each);

  /// Bytes that are no UTF-8 are shown as '?'.
  void text(const std::string& text, const Eigen::Vector2d& at, const TextAnchor& anchor, const Font& font);
  /// Runs upwards; its anchor is that of the text as it is read.
  void text_upwards(const std::string& text, const Eigen::Vector2d& at, const TextAnchor& anchor,
                    const Font& font);
  /// Stands out from whatever is below it.
  void text_on_map(const std::string& text, const Eigen::Vector2d& at, const TextAnchor& anchor,
                   const Font& font);
  /// Width, and height of a line.
  static Eigen::Vector2d size_of(const std::string& text, const Font& font);

  /// What is drawn from now on shows only inside the box, until `unclip`.
  void clip(const PixelBox& box);
  void unclip();

  Rgb pixel(int column, int row) const;
  /// Throws std::runtime_error where anything could not be drawn or encoded.
  std::string png() const;
  void write(const std::string& path) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isthmus
