#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/wire/journal/journal.hpp"
#include "server/wire/journal/journal_files.hpp"
#include "server/wire/journal/recovery/recovery.hpp"

namespace {

using namespace isthmus;
namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

const fs::path& directory() {
  static const fs::path path = fs::temp_directory_path() / ("isthmus-fuzz-" + std::to_string(getpid()));
  return path;
}

std::vector<Message> written() {
  std::vector<Message> messages = {encode({1, ConfigurationEvent{}})};
  RobotEvent robot;
  robot.robot = "R1";
  robot.laser.range_max_m = 30;
  messages.push_back(encode({2, robot}));
  for (int i = 3; i < 12; ++i) messages.push_back(encode({i, OdometryEvent{"R1", i, {0.1 * i, 0, 0}}}));
  return messages;
}

Bytes read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(const fs::path& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// A journal's segments, whole.
std::vector<Bytes> whole_segments() {
  fs::remove_all(directory());
  JournalOptions options;
  options.segment_bytes = 1500;
  {
    Journal journal(directory().string(), options);
    for (const Message& message : written()) journal.append(message);
  }
  std::vector<Bytes> segments;
  for (const auto& [number, path] : list_journal(directory().string()).segments)
    segments.push_back(read(path));
  return segments;
}

/// The first byte says how the segment is damaged, two more say where, the rest is put there.
Bytes damaged(Bytes segment, std::span<const std::uint8_t> input) {
  if (input.size() < 3) return segment;
  const auto how = input[0] % 4;
  const auto at = static_cast<std::ptrdiff_t>((input[1] * 256U + input[2]) % (segment.size() + 1));
  const auto rest = input.subspan(3);
  if (how == 0) return {rest.begin(), rest.end()};
  if (how == 1) segment.resize(static_cast<std::size_t>(at));
  if (how == 2) segment.insert(segment.begin() + at, rest.begin(), rest.end());
  if (how == 1) segment.insert(segment.end(), rest.begin(), rest.end());
  if (how == 3)
    std::copy_n(rest.begin(), std::min(rest.size(), segment.size() - static_cast<std::size_t>(at)),
                segment.begin() + at);
  return segment;
}

/// Nothing is read but what was written, in its order, and what `go_on` adds.
void check_read(const std::string& journal) {
  const std::vector<Message> all = written();
  auto next = all.begin();
  EventLogReader reader(journal);
  while (const auto message = reader.next()) {
    if (message->channel == "ISTHMUS_TICK" || message->channel == "ISTHMUS_COUNTERS") continue;
    next = std::find_if(next, all.end(), [&](const Message& one) {
      return one.utime == message->utime && one.channel == message->channel && one.bytes == message->bytes;
    });
    if (next == all.end()) std::abort();
    ++next;
  }
}

void recover(const std::string& journal) {
  Recovery recovery(journal);
  ServedMap map = recovery.begin();
  while (recovery.step(map)) {
  }
}

/// It goes on behind what is left, and a second opening finds nothing more to cut.
void go_on(const std::string& journal) {
  {
    Journal again(journal);
    again.count_signatures();
    if (!again.append(encode({99, TickEvent{}}))) std::abort();
  }
  if (Journal(journal).torn_bytes() != 0) std::abort();
}

}  // namespace

/// Input: how a segment of a journal was damaged. The journal is refused with a reason, or read without a
/// word that was not written, recovered and gone on with.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<Bytes> segments = whole_segments();
  const bool is_last = size > 0 && data[0] >= 128;
  const std::size_t chosen = is_last ? segments.size() - 1 : 0;
  fs::remove_all(directory());
  fs::create_directory(directory());
  const std::string journal = directory().string();
  for (std::size_t i = 0; i < segments.size(); ++i)
    write(segment_path(journal, static_cast<int>(i) + 1),
          i == chosen ? damaged(segments[i], {data, size}) : segments[i]);
  bool is_refused = false;
  try {
    check_read(journal);
  } catch (const std::runtime_error&) {
    is_refused = true;
  }
  if (!is_refused) {
    recover(journal);
    go_on(journal);
    check_read(journal);
  }
  fs::remove_all(directory());
  return 0;
}
