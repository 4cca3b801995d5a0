#include "server/output/pictures/colours.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <set>
#include <tuple>

namespace isthmus {
namespace {

double linear(std::uint8_t value) {
  const double v = value / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

Eigen::Vector3d linear_rgb(Rgb colour) {
  return {linear(colour.red), linear(colour.green), linear(colour.blue)};
}

/// What a deuteranope sees (Machado, Oliveira and Fernandes, TVCG 15, 2009, severity 1).
Eigen::Vector3d as_deuteranope(const Eigen::Vector3d& rgb) {
  Eigen::Matrix3d machado;
  machado << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881;
  return (machado * rgb).cwiseMax(0.0).cwiseMin(1.0);
}

/// The same for a protanope.
Eigen::Vector3d as_protanope(const Eigen::Vector3d& rgb) {
  Eigen::Matrix3d machado;
  machado << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998;
  return (machado * rgb).cwiseMax(0.0).cwiseMin(1.0);
}

Eigen::Vector3d as_it_is(const Eigen::Vector3d& rgb) { return rgb; }

/// CIELAB at D65.
Eigen::Vector3d lab(const Eigen::Vector3d& rgb) {
  Eigen::Matrix3d to_xyz;
  to_xyz << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
  const Eigen::Vector3d xyz = (to_xyz * rgb).cwiseQuotient(Eigen::Vector3d(0.95047, 1, 1.08883));
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
  return {116 * f(xyz.y()) - 16, 500 * (f(xyz.x()) - f(xyz.y())), 200 * (f(xyz.y()) - f(xyz.z()))};
}

using Eyes = Eigen::Vector3d (*)(const Eigen::Vector3d&);

double difference(Rgb a, Rgb b, Eyes eyes) {
  return (lab(eyes(linear_rgb(a))) - lab(eyes(linear_rgb(b)))).norm();
}

/// ΔE*ab of 2.3 is a just noticeable difference; lines are thin, so five times that.
constexpr double clearly_different = 11.5;

TEST(WayStyle, TheColourBlindTellTheColoursApart) {
  for (const Eyes eyes : {as_it_is, as_deuteranope, as_protanope})
    for (std::size_t i = 0; i < robot_colour_count; ++i) {
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_GT(difference(way_style(i).colour, way_style(j).colour, eyes), clearly_different)
            << i << ", " << j;
      EXPECT_GT(difference(way_style(i).colour, ink::floor, eyes), clearly_different) << i;
      EXPECT_GT(difference(way_style(i).colour, ink::wall, eyes), clearly_different) << i;
    }
}

TEST(WayStyle, NeighboursDifferInColourAndInDashes) {
  for (std::size_t i = 0; i + 1 < 3 * way_styles; ++i) {
    EXPECT_NE(way_style(i).colour, way_style(i + 1).colour) << i;
    EXPECT_NE(way_style(i).dashes, way_style(i + 1).dashes) << i;
  }
}

TEST(WayStyle, NoTwoOfTheFirstRobotsHaveTheSame) {
  std::set<std::tuple<int, int, int, std::vector<double>>> styles;
  for (std::size_t i = 0; i < way_styles; ++i) {
    const WayStyle style = way_style(i);
    styles.insert({style.colour.red, style.colour.green, style.colour.blue, style.dashes});
  }
  EXPECT_EQ(styles.size(), way_styles);
}

TEST(ScaleColour, GetsEvenlyLighterForEveryEye) {
  for (const Eyes eyes : {as_it_is, as_deuteranope, as_protanope}) {
    double before = -1;
    for (int i = 0; i <= 20; ++i) {
      const double lightness = lab(eyes(linear_rgb(scale_colour(i / 20.0)))).x();
      EXPECT_GT(lightness, before) << i;
      before = lightness;
    }
  }
  EXPECT_EQ(scale_colour(-1), scale_colour(0));
  EXPECT_EQ(scale_colour(2), scale_colour(1));
}

}  // namespace
}  // namespace isthmus
