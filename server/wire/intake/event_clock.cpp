#include "server/wire/intake/event_clock.hpp"

#include <chrono>
#include <cstdlib>
#include <utility>

namespace isthmus {
namespace {

constexpr std::int64_t min_step_us = 1'000'000;

template <class Clock>
std::int64_t reading() {
  const auto now = Clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

}  // namespace

EventClock::EventClock()
    : EventClock(reading<std::chrono::system_clock>, reading<std::chrono::steady_clock>) {}

EventClock::EventClock(ClockReading wall_us, ClockReading monotonic_us)
    : wall_us_(std::move(wall_us)),
      monotonic_us_(std::move(monotonic_us)),
      start_utime_(wall_us_() - monotonic_us_()),
      wall_ahead_us_(start_utime_) {}

std::int64_t EventClock::go_on_from(std::int64_t utime) {
  const std::int64_t behind_us = utime - now();
  if (behind_us <= 0) return 0;
  start_utime_ += behind_us;
  return behind_us;
}

std::optional<std::int64_t> EventClock::take_step() {
  const std::int64_t ahead_us = wall_us_() - monotonic_us_();
  const std::int64_t step_us = ahead_us - std::exchange(wall_ahead_us_, ahead_us);
  if (std::abs(step_us) < min_step_us) return std::nullopt;
  return step_us;
}

}  // namespace isthmus
