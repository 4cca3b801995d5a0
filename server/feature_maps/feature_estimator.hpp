#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/engine/input/configuration.hpp"
#include "server/engine/outcome.hpp"
#include "server/feature_maps/feature_mapper.hpp"

namespace isthmus {

/// Maps of features with orders of operators. It keeps what the maps were made of (MapInput): a fusion that
/// is withdrawn, by an operator or because later sightings contradict it, is taken back by making the maps
/// again without it, which is what a replay with that fusion forbidden makes of the same events; the same
/// holds of a robot whose data is dropped. That takes as long as mapping took so far.
class FeatureEstimator {
 public:
  explicit FeatureEstimator(const FeatureMapOptions& options);

  /// Fusions that must not be made; before the first event.
  void forbid(const std::set<std::int32_t>& fusions);

  Outcome handle(const Event& event);
  /// Whether it is odometry, a scan or a sighting of a robot that has not introduced itself.
  bool is_stranger(const Event& event) const;
  /// Counts messages that never became events.
  void count_dropped(DropReason reason, std::int64_t messages = 1);
  /// What still waits for odometry is done without it.
  void finish(Outcome& outcome);
  const Configuration& configuration() const { return configuration_; }

  FeatureMaps maps() const;

 private:
  DropReason configure(const ConfigurationEvent& event);
  DropReason obey(const CommandEvent& order);
  DropReason allow(const CommandEvent& order);
  void keep_inputs(Outcome& outcome);
  void make_again();
  bool is_left_out(std::size_t input) const;

  FeatureMapOptions options_;
  Configuration configuration_;
  FeatureMapper mapper_;
  std::vector<MapInput> inputs_;
  std::set<std::int32_t> forbidden_;
  std::map<std::string, std::size_t> dropped_until_;  ///< inputs of a robot that are left out, to that one
  std::int64_t withdrawn_ = 0;
  std::int64_t events_ = 0;
  std::map<DropReason, std::int64_t> dropped_;
};

}  // namespace isthmus
