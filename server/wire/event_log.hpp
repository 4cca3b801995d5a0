#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/wire/message.hpp"

namespace isthmus {

/// Reads an LCM event log, with caps on lengths and resynchronisation after damage. A directory is a journal:
/// its segments `*.lcm` in order of name are read as one log.
class EventLogReader {
 public:
  /// Throws std::runtime_error naming the file and the reason where it cannot be opened or is no LCM log.
  explicit EventLogReader(const std::string& path);
  /// Files read as one log; none: there is nothing to read.
  explicit EventLogReader(std::vector<std::string> files);
  ~EventLogReader();
  EventLogReader(EventLogReader&&) noexcept;
  EventLogReader& operator=(EventLogReader&&) noexcept;

  /// The next intact event; nothing at the end.
  std::optional<Message> next();

  std::string file() const;            ///< the file being read
  std::int64_t event_number() const;   ///< of the last event returned, counted from 0
  std::int64_t offset() const;         ///< of the last event returned, in its file
  std::int64_t skipped_bytes() const;  ///< damaged bytes passed over so far, torn tail included
  double progress() const;             ///< share of all bytes read, 0 to 1

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Where the last intact event of a log file ends, and what follows it.
struct LogEnd {
  std::int64_t bytes = 0;
  std::int64_t torn_bytes = 0;
};

/// Throws std::runtime_error naming the file and the reason where it cannot be read.
LogEnd find_log_end(const std::string& file);

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
