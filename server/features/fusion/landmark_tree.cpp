#include "server/features/fusion/landmark_tree.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>

namespace isthmus {
/// Points along the features, as nanoflann asks for them.
struct LandmarkTree::Index {
  explicit Index(std::span<const Feature> features) : tree(2, *this) {
    for (std::size_t i = 0; i < features.size(); ++i) add(features[i], i);
    tree.buildIndex();
  }

  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }

  void add(const Feature& feature, std::size_t index) {
    const bool is_long = feature.kind == FeatureKind::segment;
    const int pieces = is_long ? std::max(1, static_cast<int>(std::ceil(length_m(feature)))) : 0;
    for (int k = 0; k <= pieces; ++k) {
      const double share = is_long ? static_cast<double>(k) / pieces : 0;
      points.push_back(is_long ? Eigen::Vector2d(feature.a + share * (feature.b - feature.a)) : feature.a);
      of_feature.push_back(index);
    }
  }

  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Index>, Index, 2,
                                                   std::uint32_t>;
  std::vector<Eigen::Vector2d> points;
  std::vector<std::size_t> of_feature;  ///< of each point
  Tree tree;
};

LandmarkTree::LandmarkTree(std::span<const Feature> features) : index_(std::make_unique<Index>(features)) {}
LandmarkTree::~LandmarkTree() = default;
LandmarkTree::LandmarkTree(LandmarkTree&&) noexcept = default;
LandmarkTree& LandmarkTree::operator=(LandmarkTree&&) noexcept = default;

std::vector<std::size_t> LandmarkTree::within(const Eigen::Vector2d& place, double radius_m) const {
  std::vector<std::size_t> features;
  if (index_->points.empty()) return features;
  std::vector<std::pair<std::uint32_t, double>> found;
  index_->tree.radiusSearch(place.data(), radius_m * radius_m, found, nanoflann::SearchParams(32, 0, false));
  features.reserve(found.size());
  for (const auto& [point, squared] : found) features.push_back(index_->of_feature[point]);
  std::sort(features.begin(), features.end());
  features.erase(std::unique(features.begin(), features.end()), features.end());
  return features;
}

}  // namespace isthmus
