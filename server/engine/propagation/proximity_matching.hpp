#pragma once

#include <map>
#include <string>
#include <tuple>

#include "server/engine/map/credit.hpp"
#include "server/engine/propagation/propagation.hpp"

namespace isthmus {

/// Relates patches that lie near each other where robots are: each patch that a robot comes to stand on is
/// matched with those that are well determined relative to it and lie near, but are not related to it. After
/// a merge that sightings alone have made, or a loop, layers of the same place would else lie beside each
/// other, as no new patch is made there. Works in bounded steps on credit that grows with time.
class ProximityMatching {
 public:
  void stands_on(const std::string& robot, PatchId patch, const PropagationOptions& options);
  /// Every patch of the map, wherever robots stand.
  void match_all(const Map& map, const PropagationOptions& options);
  /// Islands have merged or parted: patches that did not match may match now.
  void map_changed() { propagation_.forget_visits(); }

  void advance(Map& map, const EngineOptions& options, std::int64_t now_utime);
  bool finish_step(Map& map, const EngineOptions& options);
  bool busy() const { return !propagation_.done(); }

  auto members() { return std::tie(propagation_, stands_on_, credit_); }

 private:
  Propagation propagation_{std::nullopt, {OriginKind::match, {}}};
  std::map<std::string, PatchId> stands_on_;
  Credit credit_;
};

}  // namespace isthmus
