#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "isthmus/reply_t.hpp"
#include "patches/manifold.hpp"
#include "server/wire/page/map/shown_map.hpp"

namespace isthmus {

/// Paths and frontiers that were asked for lately, on the manifold: a fit of the map moves them along.
class Asked {
 public:
  /// Of so many askers, the newest; others are let go.
  static constexpr std::size_t max_askers = 32;
  /// For so long after it was asked for, a path is shown.
  static constexpr std::int64_t shown_us = 60'000'000;

  /// Passes over refusals, and what is neither path nor frontiers.
  void add(const reply_t& reply);

  /// A line of JSON: `asker`, `kind`, `island`, `points` [x, y], and of a frontier's view its `gain` (m²)
  /// too. `now_utime`: the server's clock.
  std::string text(const ShownMap& shown, std::int64_t now_utime);

 private:
  struct Answer {
    std::string kind;
    std::int64_t utime = 0;
    std::vector<ManifoldPose> poses;
    std::vector<double> gains_m2;  ///< by pose, of frontiers
  };

  std::map<std::string, Answer> answers_;  ///< by asker and kind
};

}  // namespace isthmus
