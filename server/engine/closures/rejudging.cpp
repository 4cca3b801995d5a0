#include "server/engine/closures/rejudging.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "relations/confidence.hpp"
#include "server/engine/map/surroundings.hpp"

namespace isthmus {
namespace {

Eigen::Vector3d gradient(const Measurement& measurement, const Pose& a_from_b) {
  constexpr double step = 1e-5;  // metres and radians: of what is smooth over centimetres
  Eigen::Vector3d gradient;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d off = step * Eigen::Vector3d::Unit(i);
    const Eigen::Vector3d at = to_vector(a_from_b);
    gradient(i) = (cost(measurement, to_pose(at + off)) - cost(measurement, to_pose(at - off))) / (2 * step);
  }
  return gradient;
}

}  // namespace

// Least of c(x + d) + dᵀP⁻¹d over d, where c = c₀ + 2gᵀd + dᵀΛd: c₀ − gᵀ(Λ + P⁻¹)⁻¹g.
double chi_squared(const Measurement& measurement, const Pose& a_from_b, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d g = gradient(measurement, a_from_b);
  const Eigen::Matrix3d sum = information(measurement, a_from_b) + covariance.inverse();
  return chi_squared(measurement, a_from_b) - g.dot(sum.inverse() * g);
}

Rejudging::Rejudging(const Map& map, const Dependencies& dependencies, const std::set<ClosureId>& without,
                     const EngineOptions& options)
    : options_(options), rest_(map) {
  std::vector<RelationId> out;
  for (const auto& [id, relation] : map.graph().relations()) {
    const auto its = dependencies.of(id);
    if (std::ranges::none_of(its, [&](ClosureId closure) { return without.contains(closure); })) continue;
    out.push_back(id);
    held_.push_back(relation);
    touched_.insert({relation.a, relation.b});
  }
  rest_.remove(out);
  std::vector<Relation> own;
  std::erase_if(held_, [&](const Relation& relation) {
    if (!without.contains(relation.origin.closure)) return false;
    own.push_back(relation);
    return true;
  });
  readmit_near();
  while (readmit_agreeing()) readmit_near();
  held_.insert(held_.end(), own.begin(), own.end());
  held_.insert(held_.end(), refuted_.begin(), refuted_.end());
  std::ranges::sort(held_, {}, &Relation::id);
}

void Rejudging::readmit_near() {
  std::erase_if(held_, [&](const Relation& relation) {
    if (!known_near(rest_.graph(), relation)) return false;
    rest_.relate(relation);
    return true;
  });
}

bool Rejudging::readmit_agreeing() {
  fit();
  std::vector<Relation> agreeing;
  std::erase_if(held_, [&](const Relation& relation) {
    const std::optional<bool> agreement = agrees(relation);
    if (agreement) (*agreement ? agreeing : refuted_).push_back(relation);
    return agreement.has_value();
  });
  for (const Relation& relation : agreeing) rest_.relate(relation);
  return !agreeing.empty();
}

// Nothing where what is left does not tell how the ends lie to one another.
std::optional<bool> Rejudging::agrees(const Relation& relation) {
  if (rest_.graph().island(relation.a) != rest_.graph().island(relation.b)) return std::nullopt;
  auto [known, is_new] = confidence_.try_emplace(relation.a);
  if (is_new)
    known->second = local_relative_covariances(rest_.graph(), rest_.manifold().poses(), relation.a,
                                               options_.surroundings.confidence_patches);
  const auto covariance = known->second.find(relation.b);
  if (covariance == known->second.end()) return std::nullopt;
  if (is_match(relation) && !well_determined(covariance->second, {options_.surroundings.loop_position_m,
                                                                  options_.surroundings.loop_yaw_rad}))
    return std::nullopt;
  const Pose a_from_b = rest_.relative_pose(relation.a, relation.b);
  return chi_squared(relation.measurement, a_from_b, covariance->second) < options_.common.surprise.bound(3);
}

void Rejudging::fit() {
  confidence_.clear();
  changed_.clear();
  for (const PatchId patch : touched_) changed_.insert(rest_.graph().island(patch));
  for (const IslandId island : changed_) rest_.refit_island(island);
}

}  // namespace isthmus
