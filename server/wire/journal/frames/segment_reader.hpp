#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/wire/file/file_bytes.hpp"
#include "server/wire/journal/frames/journal_entry.hpp"
#include "server/wire/journal/frames/log_damage.hpp"
#include "server/wire/journal/frames/segment_header.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {

/// Reads a segment of a journal. An event is taken only from behind an entry that bears the segment's check,
/// and only as it was written; after damage the next such entry is looked for. Senders cannot forge
/// entries in their messages: they do not know the segment's secret.
class SegmentReader {
 public:
  /// Throws std::runtime_error naming the file and the reason where it cannot be read or has no header.
  explicit SegmentReader(const std::string& path);

  const std::string& path() const { return file_.path(); }
  const SegmentHeader& header() const { return header_; }

  /// Entries before this one are missing, or were read already.
  void expect(std::int64_t sequence) { next_sequence_ = sequence; }

  /// The next event, or record of signature counters; nothing at the end.
  std::optional<Message> next();

  std::int64_t offset() const { return offset_; }      ///< of the last message returned
  std::int64_t position() const { return position_; }  ///< what comes before it is read
  std::int64_t size() const { return file_.size(); }
  /// The damage skipped since the last call.
  std::vector<LogDamage> take_damage();
  /// The place that this segment leads to, as far as it was read.
  JournalPlace place() const;
  /// Where the last entry that was read ends, or the header.
  std::int64_t end() const { return end_; }

 private:
  bool find_entry();
  bool take_entry(std::int64_t offset);
  void pass_over(std::int64_t end, std::int64_t missing);

  FileBytes file_;
  SegmentHeader header_;
  std::int64_t next_sequence_ = 0;
  std::int64_t received_ = -1;
  std::int64_t position_ = 0;
  std::int64_t end_ = 0;
  std::int64_t offset_ = 0;
  std::int64_t entry_received_ = -1;
  std::vector<LogDamage> damage_;
};

/// How a segment ends.
struct SegmentEnd {
  JournalPlace place;
  std::int64_t bytes = 0;  ///< up to the last entry
  std::int64_t torn_bytes =
      0;  ///< of an entry that was not written to its end; 0 where what follows is damage
};

/// Reads a segment to its end. Throws as SegmentReader.
SegmentEnd find_segment_end(const std::string& path);

}  // namespace isthmus
