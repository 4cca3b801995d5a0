#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "server/engine/estimator.hpp"
#include "server/feature_maps/mapper/feature_mapper.hpp"

namespace isthmus {

/// Maps of features as a server runs them. It keeps what the maps were made of (MapInput): a fusion that is
/// withdrawn, by an operator or because later sightings contradict it, is taken back by making the maps again
/// without it, which is what a replay with that fusion forbidden makes of the same events; the same holds of
/// a robot whose data is dropped. That takes as long as mapping took so far.
class FeatureEstimator final : public Estimator {
 public:
  explicit FeatureEstimator(const FeatureMapOptions& options);

  /// Fusions that must not be made; before the first event.
  void forbid(const std::set<std::int32_t>& fusions);

  Outcome handle(const Event& event) override;
  bool is_stranger(const Event& event) const override;
  void count_dropped(const std::string& robot, DropReason reason, std::int64_t messages) override;
  bool finish_step(Outcome& outcome) override;
  std::string_view finishing() const override { return "scans that wait for odometry"; }
  bool has_queued_work() const override { return mapper_.has_waiting(); }
  const Configuration& configuration() const override { return configuration_; }
  MapCopy copy() const override;

  FeatureMaps maps() const;

  /// All that there is: one that is restored from it continues identically.
  std::vector<std::uint8_t> save() const;
  /// Of maps of the kind. Throws std::runtime_error with the reason where it is not what was saved.
  static FeatureEstimator restore(FeatureMapKind kind, std::span<const std::uint8_t> saved);

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
  std::map<std::string, std::map<DropReason, std::int64_t>> dropped_by_robot_;
};

}  // namespace isthmus
