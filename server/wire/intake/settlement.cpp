#include "server/wire/intake/settlement.hpp"

#include <utility>

#include "server/wire/journal/drop_record.hpp"
#include "server/wire/journal/event_log.hpp"

namespace isthmus {

namespace {

void add_settled(const std::string& segment, std::set<std::int64_t>& settled) {
  EventLogReader reader(segment);
  while (const std::optional<Message> message = reader.next()) {
    if (message->received >= 0) settled.insert(message->received);
    const std::optional<Drops> drops = read_drops(*message);
    if (!drops) continue;
    for (const auto& [robot, reasons] : *drops) {
      for (const auto& [reason, dropped] : reasons)
        settled.insert(dropped.received.begin(), dropped.received.end());
    }
  }
}

}  // namespace

std::set<std::int64_t> settled_messages(const std::vector<JournalSegment>& segments, int first) {
  std::set<std::int64_t> settled;
  for (const JournalSegment& segment : segments) {
    if (segment.number >= first) add_settled(segment.path, settled);
  }
  return settled;
}

void Settlement::journalled(const Message& message) {
  if (message.received >= 0) recorded_.push_back({journal_.appended(), message.received});
}

void Settlement::dropped(const std::string& robot, DropReason reason, const Dropped& dropped) {
  Dropped& sum = drops_[robot][reason];
  sum.count += dropped.count;
  sum.received.insert(sum.received.end(), dropped.received.begin(), dropped.received.end());
}

void Settlement::record_drops(std::int64_t utime) {
  if (drops_.empty() || !journal_.append(encode_drops(utime, drops_))) return;
  for (const auto& [robot, reasons] : std::exchange(drops_, {})) {
    for (const auto& [reason, dropped] : reasons) {
      for (const std::int64_t number : dropped.received) recorded_.push_back({journal_.appended(), number});
    }
  }
}

void Settlement::settle() {
  const std::int64_t on_disk = journal_.synced();
  for (; !recorded_.empty() && recorded_.front().appended <= on_disk; recorded_.pop_front())
    spool_.settle(recorded_.front().received);
  spool_.set_journal_segment(journal_.segment());
}

}  // namespace isthmus
