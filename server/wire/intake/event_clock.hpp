#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>

namespace isthmus {

/// A clock's time in microseconds.
using ClockReading = std::function<std::int64_t()>;

/// The time of events of a server that listens: that of the wall clock when it began, and from then on as
/// much more as the monotonic clock tells. A wall clock that is set does not move it; after that it tells
/// another time than the wall clock does, until the next start. While the machine sleeps it stands still.
class EventClock {
 public:
  /// By the machine's clocks.
  EventClock();
  EventClock(ClockReading wall_us, ClockReading monotonic_us);

  /// Microseconds; never less than before. Any thread.
  std::int64_t now() const { return start_utime_ + monotonic_us_(); }

  /// Moves forward to this time at least: a journal that is continued may have later events. Returns
  /// by how much it was behind, in microseconds.
  std::int64_t go_on_from(std::int64_t utime);

  /// By how much the wall clock was set since this was last asked, in microseconds, forward or back; nothing
  /// where it was not, or by less than a second: such drift is of clocks that are kept right. One thread.
  std::optional<std::int64_t> take_step();

 private:
  ClockReading wall_us_;
  ClockReading monotonic_us_;
  std::atomic<std::int64_t> start_utime_;  ///< of the monotonic clock's zero
  std::int64_t wall_ahead_us_;             ///< of the monotonic clock, when last asked
};

}  // namespace isthmus
