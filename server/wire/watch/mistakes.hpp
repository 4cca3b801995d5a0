#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/engine/input/drop_reason.hpp"
#include "server/engine/input/words.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/watch/live_warnings.hpp"

namespace isthmus {

/// What those who connect a robot commonly get wrong, and what their robot's messages tell of it.
enum class Mistake : std::uint8_t {
  always_restarted,      ///< each robot_t says so, and each begins a new session
  another_type,          ///< a channel carries another type than its own
  barcode_of_nobody,     ///< it is seen, but nobody wears it and no tag has it
  introduction_refused,  ///< no robot_t of it was taken, for another reason than its name
  name_differs,          ///< robot_t.name is another than the channel's
  not_introduced,        ///< scans, and no robot_t before them
  other_server,          ///< on the same network
  scans_without_laser,   ///< range_max_m = 0 says that there is none
  signed_without_keys,   ///< envelopes, and the configuration has no keys
  not_signed,            ///< the configuration has keys, and no envelopes come
  wrong_time_unit,       ///< stamps are not in microseconds
};

template <>
inline constexpr auto words_of<Mistake> = std::to_array<std::string_view>({
    "always_restarted",
    "another_type",
    "barcode_of_nobody",
    "introduction_refused",
    "name_differs",
    "not_introduced",
    "other_server",
    "scans_without_laser",
    "signed_without_keys",
    "unsigned",
    "wrong_time_unit",
});
static_assert(words_of<Mistake>.size() == static_cast<std::size_t>(Mistake::wrong_time_unit) + 1);

/// Finds mistakes in the messages that come, taken or refused. One holds from its first few messages on until
/// none has come for some time. Bounded, whatever is sent. Any thread.
class Mistakes {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Mistakes(std::function<Clock::time_point()> now = Clock::now) : now_(std::move(now)) {}

  /// A robot's message, and why it was refused; none: it was taken. `utime`: when it was received; 0: that is
  /// not known.
  void note(const Channel& channel, std::span<const std::uint8_t> bytes, DropReason reason,
            std::int64_t utime);
  /// An envelope that was refused, or a message without one.
  void note_refused(const std::string& robot, DropReason reason);
  /// What is about to be sent on ISTHMUS_STATUS, and what is heard there: another server's, unless it was
  /// sent.
  void sent_status(std::span<const std::uint8_t> bytes);
  void heard_status(std::span<const std::uint8_t> bytes);

  /// Those that hold now, without the times when they began.
  std::vector<LiveWarning> warnings();

 private:
  struct Found {
    std::int64_t messages = 0;
    Clock::time_point last;
    std::string detail;  ///< a unit, a name or a barcode
  };

  void add(Mistake mistake, const std::string& robot, const std::string& detail = "");
  bool has_cause(Mistake mistake, const std::string& robot) const;
  void note_stamp(const Channel& channel, std::int64_t stamp, std::int64_t utime);
  void note_introduction(const Channel& channel, std::span<const std::uint8_t> bytes, DropReason reason);

  std::function<Clock::time_point()> now_;
  std::mutex mutex_;
  std::map<std::pair<Mistake, std::string>, Found> found_;  ///< by robot
  std::deque<std::size_t> sent_;                            ///< hashes of the last statuses
};

}  // namespace isthmus
