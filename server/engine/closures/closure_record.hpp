#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "patches/ids.hpp"
#include "server/engine/closures/joining.hpp"
#include "server/engine/map/reason.hpp"
#include "server/engine/propagation/trial_account.hpp"

namespace isthmus {

enum class ClosureKind : std::uint8_t {
  loop,   ///< of a loop on one island
  merge,  ///< of two islands
};

template <>
inline constexpr auto words_of<ClosureKind> = std::to_array<std::string_view>({"closure", "merge"});

enum class ClosureState : std::uint8_t { waiting, accepted, refused, withdrawn };

template <>
inline constexpr auto words_of<ClosureState> = std::to_array<std::string_view>({"waiting", "accepted",
                                                                                "refused", "withdrawn"});

/// A closure or merge, as report.json lists it.
struct ClosureRecord {
  ClosureId id;
  ClosureKind kind = ClosureKind::loop;
  ClosureState state = ClosureState::waiting;
  bool from_scans = false;  ///< else sightings propose it, or the operators' measured start
  std::int64_t utime = 0;
  std::vector<std::string> robots;
  Reason reason = Reason::none;
  int patches_touched = 0;
  int work_steps = 0;
  std::int64_t start_utime = 0;  ///< event time
  std::int64_t end_utime = 0;
  Joining joining;       ///< what it says
  TrialAccount account;  ///< of its last trial

  auto members() {
    return std::tie(id, kind, state, from_scans, utime, robots, reason, patches_touched, work_steps,
                    start_utime, end_utime, joining, account);
  }
};

}  // namespace isthmus
