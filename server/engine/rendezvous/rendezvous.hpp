#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/rendezvous/meeting_plan.hpp"

namespace isthmus {

/// Settles hypotheses by meetings: keeps one meeting for robots to drive to, that of the most valuable
/// hypothesis, and judges it by what they see there. A sighting decides it by the way of all sightings; that
/// two robots stood face to face and saw nobody speaks against it here. Times are receive times of events.
class Rendezvous {
 public:
  /// Chooses a meeting, or drops one whose hypothesis is decided or whose robots have left. Looks at the
  /// hypotheses only now and then; see is_due.
  void choose(const Map& map, const std::map<std::string, Robot>& robots,
              std::span<const UndecidedHypothesis> undecided, std::int64_t now_utime,
              const EngineOptions& options);
  /// Whether it is time to choose again.
  bool is_due(std::int64_t now_utime) const { return now_utime >= next_choice_utime_; }

  /// A scan of a robot that has just been placed. Returns the hypothesis that nobody's presence refutes, if
  /// this scan completes the evidence.
  std::optional<ClosureId> take_scan(const Map& map, const std::map<std::string, Robot>& robots,
                                     const std::string& robot, const Scan& scan, std::int64_t now_utime,
                                     const RendezvousOptions& options);
  /// One robot saw another, rightly or wrongly: that evidence begins anew.
  void take_sighting(const std::string& observer, const std::string& target);

  const std::optional<MeetingPlan>& meeting() const { return meeting_; }
  /// The same, for publishing.
  std::optional<MeetingRecord> record() const;

  auto members() { return std::tie(meeting_, next_choice_utime_, watch_); }

 private:
  std::optional<MeetingPlan> meeting_;
  std::int64_t next_choice_utime_ = 0;
  /// Since when each has stood in its place, looking at where the other would be, without a break; 0: it does
  /// not. And when it last did.
  struct Watch {
    std::int64_t since_utime = 0;
    std::int64_t last_utime = 0;

    auto members() { return std::tie(since_utime, last_utime); }
  };
  std::array<Watch, 2> watch_;  ///< of a and b
};

/// Whether a robot stands in its place and faces where the other would be, were the hypothesis true, and its
/// scan shows nothing there nor in between.
bool watches_for_the_other(const Map& map, const std::map<std::string, Robot>& robots,
                           const MeetingPlan& meeting, const std::string& robot, const Scan& scan,
                           const RendezvousOptions& options);

}  // namespace isthmus
