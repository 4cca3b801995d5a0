#pragma once

#include <string_view>
#include <vector>

#include "patches/features/m_space.hpp"
#include "relations/chi_squared.hpp"
#include "scanmatch/features/segmentation.hpp"

namespace isthmus {

/// Why a segment ends where it does.
enum class EndKind {
  corner,       ///< it meets the next wall: a real end
  edge,         ///< the beam beside it passes by and hits something behind: a real end
  occluded,     ///< something stands before it
  range_limit,  ///< the wall would go on beyond the laser's range
  view_edge,    ///< the scan ends
  unknown       ///< the beam beside it brought no return, or a point that tells nothing
};
std::string_view name(EndKind kind);
constexpr bool is_real(EndKind kind) { return kind == EndKind::corner || kind == EndKind::edge; }

struct PoleOptions {
  double max_radius_m = 0.5;    ///< m: rounder things are walls
  double min_radius_m = 0.02;   ///< m: thinner ones are hit by chance
  double clear_m = 0.3;         ///< m that everything beside it lies behind it
  double known_sigma_m = 0.05;  ///< m: a radius less well known is left out (q = 2)
  /// That much less χ² than a line through the same points: a circle has one parameter more.
  ChiSquaredTest better_than_line{0.9973};
  double chi_squared_per_point = 4;  ///< of the circle
};

struct ScanFeatureOptions {
  BeamNoise noise;
  SegmentationOptions segmentation;
  PoleOptions poles;
  double min_corner_rad = 0.35;  ///< rad between two walls that meet: flatter corners are ill determined
  double corner_gap_m = 0.25;    ///< m from where two lines meet to their points, besides two beams' spacing
};

struct ScanSegment {
  ObservedFeature observed;  ///< covariance of (α, ρ) and of the ends that are real, correlations included
  EndKind end_a = EndKind::unknown;
  EndKind end_b = EndKind::unknown;
  int points = 0;
};

/// The features of one scan, in the robot's frame. Corners say again what the segments that meet there say: a
/// filter takes segments, or corners and poles, lest it count a wall twice.
struct ScanFeatures {
  std::vector<ScanSegment> segments;  ///< by rising bearing
  std::vector<ObservedFeature> corners;
  std::vector<ObservedFeature> poles;
};

/// Works from 90 to 1081 beams. A scan of which nothing is straight or round gives nothing.
ScanFeatures find_features(const Scan& scan, const Laser& laser, const ScanFeatureOptions& options);

}  // namespace isthmus
