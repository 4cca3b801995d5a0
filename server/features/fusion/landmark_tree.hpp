#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "patches/features/feature.hpp"

namespace isthmus {

/// Where features are: a kd-tree over points of them (nanoflann), a segment having one each metre. Made in
/// n log n, asked in log n and what is found.
class LandmarkTree {
 public:
  explicit LandmarkTree(std::span<const Feature> features);
  ~LandmarkTree();
  LandmarkTree(LandmarkTree&&) noexcept;
  LandmarkTree& operator=(LandmarkTree&&) noexcept;

  /// Indices of the features that come within a distance of a place, ascending.
  std::vector<std::size_t> within(const Eigen::Vector2d& place, double radius_m) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace isthmus
