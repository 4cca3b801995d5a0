#include "server/wire/watch/mistakes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "isthmus/robot_t.hpp"
#include "server/wire/message/byte_check.hpp"

namespace isthmus {
namespace {

using namespace std::chrono_literals;

/// Anybody can make up names.
constexpr std::size_t max_found = 64;
constexpr std::size_t statuses_kept = 16;
constexpr std::int64_t unix_year_2001 = 1'000'000'000'000'000;  // microseconds

/// A mistake holds from so many messages on, until none has come for so long.
struct Rule {
  std::int64_t messages;
  std::chrono::seconds memory;
};

constexpr Rule rule_of(Mistake mistake) {
  switch (mistake) {
    case Mistake::always_restarted:
      return {3, 60s};  // sent every few seconds
    case Mistake::name_differs:
      return {2, 30s};
    case Mistake::introduction_refused:
    case Mistake::wrong_time_unit:
      return {1, 30s};  // one is enough to tell
    default:
      return {5, 10s};
  }
}

bool is_robots(Input input) {
  return input == Input::robot || input == Input::odometry || input == Input::scan ||
         input == Input::sighting;
}

/// What a channel of a robot carries.
std::string type_of(Input input) {
  if (input == Input::robot) return "isthmus.robot_t";
  if (input == Input::odometry) return "bot_core.pose_t";
  return input == Input::scan ? "bot_core.planar_lidar_t" : "isthmus.sighting_t";
}

/// Why an introduction is not taken.
std::string why(DropReason reason, const robot_t& robot) {
  if (reason == DropReason::barcode_taken)
    return "another robot wears barcode " + std::to_string(robot.barcode) + " (barcode_taken)";
  if (reason == DropReason::absurd_value) return "a value is beyond what is possible (absurd_value)";
  if (reason == DropReason::not_finite) return "a value is no number (not_finite)";
  return std::string(word(reason));
}

std::string plural(Input input) {
  if (input == Input::scan) return "scans";
  return input == Input::sighting ? "sightings" : "odometry";
}

/// What a stamp is in that should be in microseconds; empty where it may well be.
std::string wrong_unit(std::int64_t stamp, std::int64_t utime) {
  if (utime < unix_year_2001) return "";  // no wall clock's
  const double ratio = static_cast<double>(stamp) / static_cast<double>(utime);
  for (const auto& [factor, unit] :
       {std::pair(1e3, "nanoseconds"), {1e-3, "milliseconds"}, {1e-6, "seconds"}})
    if (std::abs(ratio / factor - 1) < 0.1) return unit;
  return "";
}

std::string sentence(Mistake mistake, const std::string& robot, const std::string& detail) {
  switch (mistake) {
    case Mistake::always_restarted:
      return robot + " says 'restarted' in every " + robot + "_ROBOT: each begins a new session; say it once";
    case Mistake::another_type:
      return detail + ", by its fingerprint, and is refused";
    case Mistake::barcode_of_nobody:
      return robot + " sees barcode " + detail + ", which no robot wears and no ISTHMUS_TAG declares";
    case Mistake::introduction_refused:
      return robot + "_ROBOT is refused, and all that it sends with it: " + detail;
    case Mistake::name_differs:
      return robot + "_ROBOT says that it is '" + detail + "': name and channel must be the same";
    case Mistake::not_introduced:
      return robot + " sends " + detail + " but has not said who it is: " + robot + "_ROBOT comes first";
    case Mistake::other_server:
      return "another server sends on this network: robots get two maps";
    case Mistake::scans_without_laser:
      return robot + " sends scans, and says by range_max_m = 0 that it has no laser: they are refused";
    case Mistake::signed_without_keys:
      return "signed messages come, and the configuration has no keys: they are refused";
    case Mistake::not_signed:
      return (robot.empty() ? std::string("messages") : "messages of " + robot) +
             " come unsigned, and the configuration has keys: they are refused";
    case Mistake::wrong_time_unit:
      return robot + "'s stamps seem to be in " + detail + ": they must be in microseconds";
  }
  return "";
}

std::size_t hash_of(std::span<const std::uint8_t> bytes) {
  return std::hash<std::string_view>()({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

constexpr std::size_t stamp_at = 8;     // behind the fingerprint: the first member of all of a robot's types
constexpr std::size_t barcode_at = 16;  // behind the stamp of a sighting

bool is_readable(DropReason reason) {
  return reason != DropReason::bad_fingerprint && reason != DropReason::bad_length &&
         reason != DropReason::bad_channel;
}

}  // namespace

void Mistakes::note(const Channel& channel, std::span<const std::uint8_t> bytes, DropReason reason,
                    std::int64_t utime) {
  if (!channel.valid || !is_robots(channel.input)) return;
  const std::lock_guard lock(mutex_);
  if (reason == DropReason::unknown_robot && channel.input != Input::robot)
    return add(Mistake::not_introduced, channel.robot, plural(channel.input));
  if (reason == DropReason::bad_fingerprint)
    return add(Mistake::another_type, channel.robot,
               default_channel(channel.input, channel.robot) + " is no " + type_of(channel.input));
  if (!is_readable(reason)) return;  // from here on the bytes are those of the channel's type
  note_stamp(channel, read_int64(bytes.subspan(stamp_at)), utime);
  if (channel.input == Input::robot) return note_introduction(channel, bytes, reason);
  if (reason == DropReason::no_laser) add(Mistake::scans_without_laser, channel.robot);
  if (reason == DropReason::unknown_barcode)
    add(Mistake::barcode_of_nobody, channel.robot, std::to_string(read_int32(bytes.subspan(barcode_at))));
}

void Mistakes::note_stamp(const Channel& channel, std::int64_t stamp, std::int64_t utime) {
  if (const std::string unit = wrong_unit(stamp, utime); !unit.empty())
    add(Mistake::wrong_time_unit, channel.robot, unit);
}

void Mistakes::note_introduction(const Channel& channel, std::span<const std::uint8_t> bytes,
                                 DropReason reason) {
  robot_t robot;
  const int size = static_cast<int>(bytes.size());
  if (robot.decode(bytes.data(), 0, size) != size) return;
  if (reason == DropReason::bad_name) return add(Mistake::name_differs, channel.robot, robot.name);
  if (reason != DropReason::none)
    return add(Mistake::introduction_refused, channel.robot, why(reason, robot));
  found_.erase({Mistake::introduction_refused, channel.robot});
  if (robot.restarted)
    add(Mistake::always_restarted, channel.robot);
  else
    found_.erase({Mistake::always_restarted, channel.robot});
}

void Mistakes::note_refused(const std::string& robot, DropReason reason) {
  const std::lock_guard lock(mutex_);
  if (reason == DropReason::not_signed) add(Mistake::not_signed, robot);
  if (reason == DropReason::no_keys) add(Mistake::signed_without_keys, "");
}

void Mistakes::sent_status(std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  sent_.push_back(hash_of(bytes));
  if (sent_.size() > statuses_kept) sent_.pop_front();
}

void Mistakes::heard_status(std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  if (std::ranges::find(sent_, hash_of(bytes)) == sent_.end()) add(Mistake::other_server, "");
}

void Mistakes::add(Mistake mistake, const std::string& robot, const std::string& detail) {
  const std::pair key(mistake, robot);
  if (found_.size() >= max_found && !found_.contains(key)) return;
  Found& found = found_[key];
  found.messages += 1;
  found.last = now_();
  found.detail = detail;
}

/// Whether another mistake brings this one about: it is none of its own, then.
bool Mistakes::has_cause(Mistake mistake, const std::string& robot) const {
  const auto made = [&](Mistake cause) { return found_.contains({cause, robot}); };
  if (mistake == Mistake::introduction_refused) return made(Mistake::wrong_time_unit);
  return mistake == Mistake::not_introduced &&
         (made(Mistake::name_differs) || made(Mistake::introduction_refused) ||
          made(Mistake::wrong_time_unit) || made(Mistake::another_type));
}

std::vector<LiveWarning> Mistakes::warnings() {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = now_();
  std::erase_if(
      found_, [&](const auto& entry) { return now - entry.second.last > rule_of(entry.first.first).memory; });
  std::vector<LiveWarning> warnings;
  for (const auto& [key, found] : found_) {
    const auto& [mistake, robot] = key;
    if (has_cause(mistake, robot)) continue;
    if (found.messages >= rule_of(mistake).messages)
      warnings.push_back({std::string(word(mistake)), robot, sentence(mistake, robot, found.detail), 0});
  }
  return warnings;
}

}  // namespace isthmus
