#pragma once

#include <Eigen/Core>

#include "patches/features/feature.hpp"

namespace isthmus {

/// M-Space (Folkesson, Jensfelt and Christensen 2007; Benedettelli et al. 2012, section 2): errors of a
/// feature are expressed in local coordinates x_p, in a frame attached to the feature, so that they do not
/// grow with its distance from the origin (no lever arm), and only the part that is known has any. Metres and
/// radians:
///
///     point    (x, y)              axes of the frame that it is given in
///     segment  (α, ρ, d_A, d_B)    frame at the middle, x across, y along it: turn of the line, its distance
///     from
///                                  the frame's origin, the ends along it; d_A and d_B where that end is
///                                  known
///     corner   (x, y, ψ)           frame at the apex, x along the bisector; ψ where the heading is known
///     pole     (x, y, r)           r where the radius is known
///
/// At most 4 by 4, on the stack.
using LocalVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 4, 1>;
using LocalMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 4>;

/// x_f: length coordinate_count.
LocalVector coordinates(const Feature& feature);
/// The feature with these x_f in the place of its own.
Feature with_coordinates(const Feature& feature, const LocalVector& x_f);

/// All components of x_p of a feature in the frame attached to another of its kind: length full_dimension.
/// Zero but for the half lengths ∓L/2 of a segment's ends and a pole's radius where the two are the same.
LocalVector local_coordinates(const Feature& frame, const Feature& feature);
/// d local_coordinates / d x_f of `feature`: full_dimension by coordinate_count. Exact for any pair.
LocalMatrix local_jacobian(const Feature& frame, const Feature& feature);
/// x_p of one less that of the other in the same frame; angles wrapped into (-pi, pi].
LocalVector local_difference(FeatureKind kind, const LocalVector& x_p, const LocalVector& other);

/// B, δx_p = B δx_f (eq. 3): q by coordinate_count, rows of the known components.
LocalMatrix project_to_local(const Feature& feature);
/// B̃, δx_f = B̃ δx_p (eq. 3): coordinate_count by q. B B̃ = 1; B̃ B is the projection on what is known, and 1
/// where all of x_f is.
LocalMatrix project_to_feature(const Feature& feature);

/// x_f + B̃ δx_p, a corner's b put back 1 m from its apex, a negative radius set to zero.
Feature corrected(const Feature& feature, const LocalVector& delta_x_p);

/// Rows of the components that are marked.
LocalMatrix rows_of(const LocalMatrix& full, const std::array<bool, 4>& which);
LocalVector rows_of(const LocalVector& full, const std::array<bool, 4>& which);

/// A segment whose unknown ends were moved along its line, to a_m and b_m from its middle, and what that
/// makes of the errors: δx_p' = change · δx_p (q by q), for ρ is taken at another point of the same line.
/// Known ends stay.
struct Stretched {
  Feature feature;
  LocalMatrix change;
};
Stretched stretched(const Feature& segment, double a_m, double b_m);

/// A feature as it was measured, with the covariance of its x_p: q by q of its known components, in order.
struct ObservedFeature {
  Feature feature;
  LocalMatrix covariance;
};
/// The feature is sound, and the covariance symmetric positive definite and of its size.
bool is_sound(const ObservedFeature& observed);

}  // namespace isthmus
