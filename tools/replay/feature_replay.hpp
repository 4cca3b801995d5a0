#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <string>

#include "server/feature_maps/feature_estimator.hpp"
#include "server/feature_maps/output/feature_files.hpp"

namespace isthmus {

struct FeatureReplayOptions {
  FeatureMapOptions map;
  std::set<std::int32_t> forbid;                             ///< fusions that must not be made
  double until_s = std::numeric_limits<double>::infinity();  ///< of event time after the first event
  std::function<void(double)> progress;
  std::function<void(const std::string&)> warn;  ///< of what is damaged
};

struct FeatureReplayResult {
  FeatureMaps maps;
  RunCost cost;
};

/// What a log's own configuration, or that of a file in its stead, says that it is to be mapped by; nothing
/// where that is the manifold.
std::optional<FeatureMapKind> feature_kind_of(const std::string& path, const std::string& config_file = "");

/// Maps by features what an LCM event log or a journal's directory holds. Throws std::runtime_error naming
/// file, event or line and reason.
FeatureReplayResult replay_features(const std::string& path, const FeatureReplayOptions& options);

/// A run in few lines.
std::string summary_text(const FeatureReplayResult& result);

}  // namespace isthmus
