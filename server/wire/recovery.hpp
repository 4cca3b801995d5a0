#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/engine/engine.hpp"
#include "server/wire/event_log.hpp"

namespace isthmus {

/// An event of a journal and what became of it; no event where it was too damaged to be one.
struct Recovered {
  std::optional<Event> event;
  Outcome outcome;
};

/// Leads an engine to where the events of a journal led: each in its order and with its time, as
/// isthmus-replay reads them.
class Recovery {
 public:
  /// Throws std::runtime_error where the journal cannot be read.
  explicit Recovery(const std::string& directory);

  /// Whether there was an intact event.
  bool has_events() const { return has_events_; }

  /// The journal's configuration, to be taken before the first `step`. Throws std::runtime_error where it is
  /// wrong.
  void configure(Engine& engine);

  /// The next event; nothing at the journal's end. Events too damaged to be read are counted as dropped.
  std::optional<Recovered> step(Engine& engine);

  std::int64_t events() const { return events_; }
  std::int64_t last_utime() const { return last_utime_; }  ///< receive time of the last event; 0: none
  std::int64_t skipped_bytes() const { return reader_.skipped_bytes(); }
  double progress() const { return reader_.progress(); }

 private:
  Recovered take(Engine& engine, const Message& message);

  EventLogReader reader_;
  std::optional<Message> first_;  ///< until it is taken
  bool has_events_;
  std::int64_t events_ = 0;
  std::int64_t last_utime_ = 0;
};

}  // namespace isthmus
