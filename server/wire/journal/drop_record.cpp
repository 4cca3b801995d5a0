#include "server/wire/journal/drop_record.hpp"

#include <array>

#include "isthmus/dropped_t.hpp"
#include "server/wire/message/byte_check.hpp"
#include "server/wire/message/encoded.hpp"

namespace isthmus {
namespace {

constexpr const char* dropped_channel = "ISTHMUS_DROPPED";
constexpr std::int32_t max_received = 16 * 1024 * 1024;
/// More than come in a lifetime; millions of such counts add up without overflow.
constexpr std::int64_t max_dropped_count = 1'000'000'000'000;
constexpr std::array drop_members = {text(64), text(64), fixed(8), array(8, max_received)};
constexpr std::array dropped_members = {list(drop_members, 100'000)};

}  // namespace

Message encode_drops(std::int64_t utime, const Drops& drops) {
  dropped_t record{};
  for (const auto& [robot, reasons] : drops) {
    for (const auto& [reason, dropped] : reasons) {
      drop_t one{};
      one.robot = robot;
      one.reason = word(reason);
      one.count = dropped.count;
      one.received = dropped.received;
      one.nreceived = static_cast<std::int32_t>(one.received.size());
      record.drops.push_back(std::move(one));
    }
  }
  record.ndrops = static_cast<std::int32_t>(record.drops.size());
  return {utime, dropped_channel, encoded(record)};
}

std::optional<Drops> read_drops(const Message& message) {
  if (message.channel != dropped_channel) return std::nullopt;
  if (check_bytes(dropped_t::getHash(), dropped_members, message.bytes) != DropReason::none)
    return std::nullopt;
  dropped_t record;
  const int size = static_cast<int>(message.bytes.size());
  if (record.decode(message.bytes.data(), 0, size) != size) return std::nullopt;
  Drops drops;
  for (const drop_t& one : record.drops) {
    const std::optional<DropReason> reason = value_of<DropReason>(one.reason);
    if (!reason || *reason == DropReason::none) return std::nullopt;
    if (one.count < 0 || one.count > max_dropped_count) return std::nullopt;
    Dropped& dropped = drops[one.robot][*reason];
    dropped.count += one.count;
    dropped.received.insert(dropped.received.end(), one.received.begin(), one.received.end());
  }
  return drops;
}

void count_drops(Estimator& estimator, const Drops& drops) {
  for (const auto& [robot, reasons] : drops) {
    for (const auto& [reason, dropped] : reasons) {
      if (dropped.count > 0) estimator.count_dropped(robot, reason, dropped.count);
    }
  }
}

}  // namespace isthmus
