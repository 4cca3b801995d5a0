#pragma once

#include <vector>

#include "patches/features/m_space.hpp"

namespace isthmus {

/// A segment or pole as one scan saw it, in the island's frame. The covariance has in it how far the scan
/// itself may lie wrong.
struct FeatureSeen {
  ObservedFeature observed;
  int view = 0;  ///< index of the scan, or of whatever saw it
};

/// What a scan looked through: its beams, from the laser to where each ended, in the island's frame.
struct View {
  Eigen::Vector2d eye = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> ends;
};

/// What a floor plan is made of, whoever estimated it.
struct PlanSource {
  std::vector<FeatureSeen> segments;
  std::vector<FeatureSeen> poles;
  std::vector<View> views;  ///< may be empty: then openings are gaps between ends that are known
};

}  // namespace isthmus
