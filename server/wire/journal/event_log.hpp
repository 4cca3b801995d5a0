#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/wire/journal/journal_view.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {

/// Reads an LCM event log: an ordinary one (LogFile), a segment of a journal, or a journal's directory, whose
/// segments are read as one log. What a journal holds is verified (SegmentReader, view_journal), for the
/// server and all tools alike; in place of an event that is set aside comes a record that it was dropped. One
/// that was written before journals had checks is read like ordinary logs.
class EventLogReader {
 public:
  /// Throws std::runtime_error naming the file and the reason where it cannot be opened, is no LCM log, or is
  /// a journal whose segments do not belong together.
  explicit EventLogReader(const std::string& path);
  /// A journal's segments after a place, up to the one with number `last`.
  EventLogReader(const JournalView& journal, const JournalPlace& from,
                 int last = std::numeric_limits<int>::max());
  ~EventLogReader();
  EventLogReader(EventLogReader&&) noexcept;
  EventLogReader& operator=(EventLogReader&&) noexcept;

  /// The next intact event; nothing at the end.
  std::optional<Message> next();

  std::string file() const;           ///< the file being read
  std::int64_t event_number() const;  ///< of the last event returned, counted from 0
  std::int64_t offset() const;        ///< of the last event returned, in its file
  double progress() const;            ///< share of all bytes read, 0 to 1
  JournalPlace place() const;         ///< how far a journal was read

  std::int64_t skipped_bytes() const;   ///< damaged bytes passed over so far, torn tail included
  std::int64_t missing_events() const;  ///< that a journal is known to lack, so far
  /// What is to be said of the log since the last call: of each damaged file the first place, and at its end
  /// the number of others.
  std::vector<std::string> take_warnings();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Writes an LCM event log. `finish` renames the temporary file to its name; without it nothing is left
/// there.
class EventLogWriter {
 public:
  /// Throws std::runtime_error naming the file and the reason.
  explicit EventLogWriter(const std::string& path);
  ~EventLogWriter();

  void write(const Message& message);
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isthmus
