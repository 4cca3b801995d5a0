#include "server/output/pictures/colours.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace isthmus {
namespace {

constexpr std::array<Rgb, robot_colour_count> robot_colours = {{{0, 114, 178},
                                                                {213, 94, 0},
                                                                {0, 158, 115},
                                                                {204, 121, 167},
                                                                {230, 159, 0},
                                                                {86, 180, 233},
                                                                {85, 0, 153},
                                                                {136, 34, 0},
                                                                {102, 68, 255},
                                                                {0, 0, 221},
                                                                {119, 102, 102},
                                                                {153, 119, 238},
                                                                {34, 204, 119},
                                                                {136, 34, 102},
                                                                {204, 17, 51},
                                                                {204, 17, 170}}};

const std::array<std::vector<double>, 4> robot_dashes = {{{}, {5, 2}, {1.2, 1.6}, {6, 2, 1.2, 2}}};

/// Cividis at equal steps.
constexpr std::array<Rgb, 9> cividis = {{{0, 34, 78},
                                         {18, 53, 112},
                                         {59, 73, 108},
                                         {87, 93, 109},
                                         {112, 113, 115},
                                         {138, 134, 120},
                                         {165, 156, 116},
                                         {195, 179, 105},
                                         {254, 232, 56}}};

std::uint8_t between(std::uint8_t from, std::uint8_t to, double share) {
  return static_cast<std::uint8_t>(std::lround(from + (to - from) * share));
}

}  // namespace

WayStyle way_style(std::size_t robot) {
  const std::size_t colours = robot_colours.size(), dashes = robot_dashes.size();
  // Colours and dashes come round together: each time that they do, the dashes are one further.
  return {robot_colours[robot % colours], robot_dashes[(robot + robot / colours) % dashes]};
}

Rgb scale_colour(double share) {
  const double at = std::clamp(share, 0.0, 1.0) * (cividis.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(at), cividis.size() - 2);
  const Rgb &a = cividis[below], &b = cividis[below + 1];
  const double part = at - static_cast<double>(below);
  return {between(a.red, b.red, part), between(a.green, b.green, part), between(a.blue, b.blue, part)};
}

}  // namespace isthmus
