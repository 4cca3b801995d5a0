#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/map/dependencies.hpp"
#include "server/engine/map/map.hpp"

namespace isthmus {

/// Judges again, on a copy of a map, what depends on closures that are taken out of it.
class Rejudging {
 public:
  Rejudging(const Map& map, const Dependencies& dependencies, const std::set<ClosureId>& without,
            const EngineOptions& options);

  /// What does not stay, by id.
  const std::vector<Relation>& gone() const { return held_; }
  /// The map without it, its islands fitted.
  const Map& rest() const { return rest_; }
  /// A patch of each island that has changed.
  const std::set<IslandId>& changed() const { return changed_; }

 private:
  void readmit_near();
  bool readmit_agreeing();
  std::optional<bool> agrees(const Relation& relation);
  void fit();

  EngineOptions options_;
  Map rest_;
  std::vector<Relation> held_;     // by id
  std::vector<Relation> refuted_;  // what comes to be near later is no better for it
  std::set<PatchId> touched_;
  std::set<IslandId> changed_;
  std::map<PatchId, std::map<PatchId, Eigen::Matrix3d>>
      confidence_;  // by reference; of the map as fitted last
};

/// Squared distance in sigmas of what a measurement says from a relative pose known with a covariance. Linear
/// in the way from that pose.
double chi_squared(const Measurement& measurement, const Pose& a_from_b, const Eigen::Matrix3d& covariance);

}  // namespace isthmus
