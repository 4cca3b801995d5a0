#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "server/engine/input/event.hpp"

namespace isthmus {

/// Events of one source in its own order. The events of one line stay together, and their receive time is the
/// highest stamp that the source has shown so far.
class EventSource {
 public:
  virtual ~EventSource() = default;

  /// Receive time of the next line; nothing at the end.
  std::optional<std::int64_t> peek();
  /// The next line's events.
  std::vector<Event> take();
  virtual double progress() const = 0;  ///< share of the work done, 0 to 1

 protected:
  /// Appends the next line's events, after `note`-ing its stamp; false at the end.
  virtual bool read(std::vector<Event>& events) = 0;
  void note(std::int64_t utime);

 private:
  std::int64_t latest_ = std::numeric_limits<std::int64_t>::min();
  std::vector<Event> pending_;
};

/// Events that are in memory, each a line of its own.
class ListSource final : public EventSource {
 public:
  using Body = decltype(Event::body);

  void add(std::int64_t utime, Body body) { lines_.push_back({utime, std::move(body)}); }
  double progress() const override;

 private:
  struct Line {
    std::int64_t utime = 0;
    Body body;
  };
  bool read(std::vector<Event>& events) override;

  std::vector<Line> lines_;
  std::size_t next_ = 0;
};

/// All sources merged by receive time; at the same time the earlier source goes first. `progress` gets the
/// mean share of the sources.
void merge_sources(const std::vector<EventSource*>& sources, const std::function<void(const Event&)>& sink,
                   const std::function<void(double)>& progress);

}  // namespace isthmus
