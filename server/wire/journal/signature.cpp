#include "server/wire/journal/signature.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "isthmus/counters_t.hpp"
#include "server/wire/journal/event_log.hpp"
#include "server/wire/message/byte_check.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/message/encoded.hpp"

namespace isthmus {
namespace {

constexpr const char* counters_channel = "ISTHMUS_COUNTERS";
constexpr std::array counter_members = {text(64), text(64), fixed(8)};
constexpr std::array counters_members = {fixed(1), list(counter_members, 100'000)};

}  // namespace

Message encode_counters(std::int64_t utime, const SignatureCounters& counters, bool complete) {
  counters_t record{};
  record.complete = complete ? 1 : 0;
  for (const auto& [stream, counter] : counters) {
    counter_t one{};
    one.sender = stream.first;
    one.channel = stream.second;
    one.counter = counter;
    record.counters.push_back(std::move(one));
  }
  record.ncounters = static_cast<std::int32_t>(record.counters.size());
  return {utime, counters_channel, encoded(record)};
}

bool may_be_counters(std::span<const std::uint8_t> beginning, std::int64_t bytes) {
  return may_begin(counters_t::getHash(), counters_members, beginning, bytes);
}

bool raise_counters(const Message& message, SignatureCounters& counters, bool& complete) {
  if (message.channel != counters_channel) return false;
  if (check_bytes(counters_t::getHash(), counters_members, message.bytes) != DropReason::none) return false;
  counters_t record;
  const int size = static_cast<int>(message.bytes.size());
  if (record.decode(message.bytes.data(), 0, size) != size) return false;
  for (const counter_t& one : record.counters) {
    const auto [found, is_new] = counters.emplace(std::pair(one.sender, one.channel), one.counter);
    if (!is_new) found->second = std::max(found->second, one.counter);
  }
  complete = record.complete != 0;
  return true;
}

bool begins_with_counters(const std::string& segment) {
  EventLogReader reader(segment);
  SignatureCounters counters;
  bool complete = false;
  while (const std::optional<Message> message = reader.next()) {
    if (raise_counters(*message, counters, complete)) return true;
    if (find_channel({}, message->channel)) return false;
  }
  return false;
}

}  // namespace isthmus
