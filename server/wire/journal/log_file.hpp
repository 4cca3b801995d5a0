#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/wire/file/file_bytes.hpp"
#include "server/wire/journal/frames/log_damage.hpp"
#include "server/wire/journal/frames/log_frame.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {

/// Reads one ordinary LCM log, which has no checks; resynchronises after damage.
///
/// What a frame claims as its own is searched for other frames only where its lengths may be damaged: it ends
/// neither at a frame nor at the end of the file, and its message does not say itself that it is so long. All
/// that Isthmus takes says so (see `may_be_input`), so that what a robot spells in its scan stays its scan,
/// also where the scan is the last of a log that was cut off, or what follows it is damaged.
class LogFile {
 public:
  /// Throws std::runtime_error naming the file and the reason.
  explicit LogFile(const std::string& path) : file_(path) {}

  const std::string& path() const { return file_.path(); }
  std::int64_t size() const { return file_.size(); }
  std::int64_t position() const { return position_; }  ///< what comes before it is read
  std::int64_t offset() const { return offset_; }      ///< of the last event returned

  /// Whether it begins as a log does, or is empty.
  bool begins_as_log();
  /// Whether an intact event follows.
  bool has_next() { return find().has_value(); }
  /// The next intact event; nothing at the end.
  std::optional<Message> next();
  /// The damage skipped since the last call.
  std::vector<LogDamage> take_damage();

 private:
  std::optional<LogHeader> find();
  std::optional<LogHeader> header_at(std::int64_t offset);
  bool is_intact(const LogHeader& header);
  bool knows_its_length(const LogHeader& header);

  FileBytes file_;
  std::int64_t position_ = 0;
  std::int64_t offset_ = 0;
  std::vector<LogDamage> damage_;
};

}  // namespace isthmus
