#include "tools/import/event_source.hpp"

#include <algorithm>
#include <utility>

namespace isthmus {

std::optional<std::int64_t> EventSource::peek() {
  if (pending_.empty() && read(pending_)) {
    for (Event& event : pending_) event.receive_utime = latest_;
  }
  if (pending_.empty()) return std::nullopt;
  return latest_;
}

std::vector<Event> EventSource::take() { return std::exchange(pending_, {}); }

void EventSource::note(std::int64_t utime) { latest_ = std::max(latest_, utime); }

double ListSource::progress() const {
  return lines_.empty() ? 1 : static_cast<double>(next_) / static_cast<double>(lines_.size());
}

bool ListSource::read(std::vector<Event>& events) {
  if (next_ == lines_.size()) return false;
  Line& line = lines_[next_++];
  note(line.utime);
  events.push_back({0, std::move(line.body)});
  return true;
}

void merge_sources(const std::vector<EventSource*>& sources, const std::function<void(const Event&)>& sink,
                   const std::function<void(double)>& progress) {
  std::size_t lines = 0;
  while (true) {
    EventSource* next = nullptr;
    std::int64_t next_utime = 0;
    for (EventSource* source : sources) {
      const auto utime = source->peek();
      if (!utime || (next != nullptr && *utime >= next_utime)) continue;
      next = source;
      next_utime = *utime;
    }
    if (next == nullptr) return;
    for (const Event& event : next->take()) sink(event);
    if (progress && ++lines % 1000 == 0) {
      double share = 0;
      for (const EventSource* source : sources)
        share += source->progress() / static_cast<double>(sources.size());
      progress(share);
    }
  }
}

}  // namespace isthmus
