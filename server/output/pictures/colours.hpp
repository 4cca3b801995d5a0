#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace isthmus {

/// A colour as a screen shows it (sRGB).
struct Rgb {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;

  bool operator==(const Rgb&) const = default;
};

/// What everything on pictures of maps is drawn in.
namespace ink {
inline constexpr Rgb paper = {255, 255, 255};
inline constexpr Rgb wall = {38, 42, 51};
inline constexpr Rgb unknown = {214, 217, 222};
inline constexpr Rgb floor = {252, 252, 252};
inline constexpr Rgb text = {38, 42, 51};
inline constexpr Rgb faint = {90, 96, 108};
inline constexpr Rgb tag = {0, 0, 0};
inline constexpr Rgb closure = {0, 0, 0};
}  // namespace ink

/// How a robot's way is drawn. Lengths of dashes and gaps are in widths of the line; none: unbroken.
struct WayStyle {
  Rgb colour;
  std::vector<double> dashes;
};

/// How many robots have a colour that no other has,
inline constexpr std::size_t robot_colour_count = 16;
/// and how many a style.
inline constexpr std::size_t way_styles = 4 * robot_colour_count;

/// Robots side by side differ in colour and in dashes; the colours are those that the colour-blind tell apart
/// too (Okabe and Ito 2008), without black, which walls have, and yellow, which is hard to see on white. Ten
/// more were searched for that lie as far as can be from all others and from walls, in OKLab (Ottosson 2020)
/// as seen by everybody, by protanopes and by deuteranopes. The operators' page has the same.
WayStyle way_style(std::size_t robot);

/// A colour for a share from 0 to 1, dark blue to yellow; its lightness grows evenly, also for the
/// colour-blind (cividis; Nuñez, Anderton and Renslow, PLOS ONE 13, 2018).
Rgb scale_colour(double share);

}  // namespace isthmus
