#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <lcm/lcm-cpp.hpp>

#include "server/wire/journal/journal.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

using rc::gen::arbitrary;
using rc::gen::inRange;

std::vector<Message> random_messages() {
  std::vector<Message> messages(static_cast<std::size_t>(*inRange(1, 20)));
  for (Message& message : messages) {
    message.utime = *arbitrary<std::int64_t>();
    message.channel = *rc::gen::nonEmpty(rc::gen::container<std::string>(inRange<char>('A', 'Z')));
    message.bytes = *arbitrary<std::vector<std::uint8_t>>();
  }
  return messages;
}

/// Whether `part` is found in `whole`, in order.
bool in_order(const std::vector<Message>& part, const std::vector<Message>& whole) {
  auto at = whole.begin();
  for (const Message& message : part) {
    at = std::find_if(at, whole.end(), [&](const Message& other) { return same(message, other); });
    if (at == whole.end()) return false;
    ++at;
  }
  return true;
}

TEST(EventLogProperty, ReadsWhatLiblcmReads) {
  EXPECT_TRUE(rc::check([] {
    const std::vector<Message> messages = random_messages();
    TemporaryDirectory directory;
    write_log(directory / "a.lcm", messages);
    const LogContent content = read_log(directory / "a.lcm");
    RC_ASSERT(content.messages.size() == messages.size());
    lcm::LogFile oracle(directory / "a.lcm", "r");
    for (const Message& message : content.messages) {
      const lcm::LogEvent* event = oracle.readNextEvent();
      RC_ASSERT(event != nullptr);
      const auto* data = static_cast<const std::uint8_t*>(event->data);
      RC_ASSERT(same(message, {event->timestamp, event->channel, {data, data + event->datalen}}));
    }
    RC_ASSERT(oracle.readNextEvent() == nullptr);
  }));
}

TEST(EventLogProperty, ReadsEveryEventThatDamageElsewhereLeftIntact) {
  EXPECT_TRUE(rc::check([] {
    const std::vector<Message> messages = random_messages();
    TemporaryDirectory directory;
    write_log(directory / "a.lcm", messages);
    std::vector<std::uint8_t> bytes = read_bytes(directory / "a.lcm");
    const std::vector<std::size_t> ends = frame_ends(messages);
    const std::size_t bit = *inRange<std::size_t>(0, bytes.size() * 8);
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1 << bit % 8);
    const std::size_t cut = *inRange<std::size_t>(bit / 8 + 1, bytes.size() + 1);
    bytes.resize(cut);
    write_bytes(directory / "b.lcm", bytes);

    std::vector<Message> intact;
    for (std::size_t i = 0; i < messages.size(); ++i) {
      const std::size_t begin = i == 0 ? 0 : ends[i - 1];
      const bool damaged = bit / 8 >= begin && bit / 8 < ends[i];
      if (!damaged && ends[i] <= cut) intact.push_back(messages[i]);
    }
    if (intact.empty()) return;
    RC_ASSERT(in_order(intact, read_log(directory / "b.lcm").messages));
  }));
}

TEST(EventLogProperty, AccountsForEveryByte) {
  EXPECT_TRUE(rc::check([] {
    const std::vector<Message> messages = random_messages();
    TemporaryDirectory directory;
    write_log(directory / "a.lcm", messages);
    std::vector<std::uint8_t> bytes = read_bytes(directory / "a.lcm");
    for (int i = *inRange(0, 4); i > 0; --i)
      bytes[*inRange<std::size_t>(0, bytes.size())] = *arbitrary<std::uint8_t>();
    write_bytes(directory / "b.lcm", bytes);
    LogContent content;
    try {
      content = read_log(directory / "b.lcm");
    } catch (const std::runtime_error&) {
      return;  // nothing left that is like a log
    }
    const std::vector<std::size_t> ends = frame_ends(content.messages);
    const std::size_t read = ends.empty() ? 0 : ends.back();
    RC_ASSERT(read + static_cast<std::size_t>(content.skipped) == bytes.size());
  }));
}

/// A part of it overwritten, cut out, or something put in between.
std::vector<std::uint8_t> damaged(std::vector<std::uint8_t> bytes) {
  const auto at = *inRange<std::size_t>(0, bytes.size());
  const auto count = std::min(*inRange<std::size_t>(1, 300), bytes.size() - at);
  const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at);
  const auto end = begin + static_cast<std::ptrdiff_t>(count);
  const int how = *inRange(0, 3);
  if (how == 0) std::generate(begin, end, [] { return *arbitrary<std::uint8_t>(); });
  if (how == 1) bytes.erase(begin, end);
  if (how == 2) bytes.insert(begin, count, *arbitrary<std::uint8_t>());
  return bytes;
}

/// What happens to the bytes behind the segment's header loses events at most, and each is counted that
/// others follow.
TEST(JournalProperty, ReadsOnlyWhatWasWrittenAndCountsWhatIsMissing) {
  EXPECT_TRUE(rc::check([] {
    const std::vector<Message> messages = random_messages();
    TemporaryDirectory directory;
    {
      Journal journal(directory / "j");
      for (const Message& message : messages) journal.append(message);
    }
    const std::string segment = directory / "j/journal-000001.lcm";
    const std::vector<std::uint8_t> bytes = read_bytes(segment);
    const auto header = bytes.begin() + segment_header_bytes;
    std::vector<std::uint8_t> rest = damaged({header, bytes.end()});
    if (*arbitrary<bool>()) rest = damaged(rest);
    rest.insert(rest.begin(), bytes.begin(), header);
    write_bytes(segment, rest);
    const LogContent content = read_log(directory / "j");
    RC_ASSERT(in_order(content.messages, messages));
    const auto lost = static_cast<std::int64_t>(messages.size() - content.messages.size());
    RC_ASSERT(content.missing <= lost);
    const bool to_the_end = !content.messages.empty() && same(content.messages.back(), messages.back());
    if (to_the_end) RC_ASSERT(content.missing == lost);
    RC_ASSERT(lost == 0 || content.skipped > 0 || content.missing > 0 || rest.size() < bytes.size());
  }));
}

}  // namespace
}  // namespace isthmus
