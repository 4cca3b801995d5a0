#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>

#include "patches/pose.hpp"

namespace isthmus {

/// What a feature is. All are one thing: points of the plane, of which a measurement may tell only a part.
enum class FeatureKind {
  point,    ///< a landmark
  segment,  ///< a straight piece of wall, seen from one side
  corner,   ///< where two walls meet
  pole      ///< a circle: a pillar, a tree
};
std::string_view name(FeatureKind kind);

/// A feature in the plane, with what of it is known (Benedettelli et al. 2012, section 2). Metres and
/// radians, in whatever frame the owner says. Its coordinates x_f in that frame are
///
///     point    a
///     segment  a, b     its ends; the observer, facing it, has a on its right and b on its left
///     corner   a, b     its apex, and the point 1 m from it along the bisector of its free side
///     pole     a, r     its centre and radius
///
/// An end that is not `known` is only as far as the wall was seen: the wall goes on behind it.
struct Feature {
  FeatureKind kind = FeatureKind::point;
  Eigen::Vector2d a = Eigen::Vector2d::Zero();
  Eigen::Vector2d b = Eigen::Vector2d::Zero();
  double radius_m = 0;
  double opening_rad =
      0;  ///< of a corner: the angle of its free side, by which corners are told apart; not estimated
  bool end_a_known = false;   ///< of a segment
  bool end_b_known = false;   ///< of a segment
  bool heading_known = true;  ///< of a corner
  bool radius_known = false;  ///< of a pole
};

Feature point_feature(const Eigen::Vector2d& place);
Feature segment_feature(const Eigen::Vector2d& a, const Eigen::Vector2d& b, bool end_a_known,
                        bool end_b_known);
Feature corner_feature(const Eigen::Vector2d& apex, double bisector_rad, double opening_rad);
Feature pole_feature(const Eigen::Vector2d& centre, double radius_m, bool radius_known);

/// Two points closer than this make no line.
constexpr double shortest_segment_m = 1e-3;

/// Whether it is one: finite, a segment longer than `shortest_segment_m`, a corner's b 1 m from its apex, a
/// radius that is not negative.
bool is_sound(const Feature& feature);

/// Group points: how many points of the plane a feature is made of (1 or 2).
int point_count(FeatureKind kind);
/// Length of x_f: 2, 4, 4, 3.
int coordinate_count(FeatureKind kind);
/// Length of x_p with all of the feature known: 2, 4, 3, 3.
int full_dimension(FeatureKind kind);

/// Which components of x_p (patches/features/m_space.hpp) are known; those beyond full_dimension are not.
std::array<bool, 4> known_components(const Feature& feature);
/// q, their number: from 2 to full_dimension.
int dimension(const Feature& feature);

/// Of a segment, and of a corner's bisector: from a to b.
double length_m(const Feature& feature);
Eigen::Vector2d along(const Feature& feature);  ///< unit, from a to b
Eigen::Vector2d across(
    const Feature& feature);  ///< unit, a quarter turn clockwise of `along`: away from the observer

/// Halfway between a segment's ends; the place of others.
Eigen::Vector2d middle(const Feature& feature);

/// The feature of frame b, in frame a.
Feature operator*(const Pose& a_from_b, const Feature& feature_b);

}  // namespace isthmus
