#include "server/wire/page/texts/bulletin.hpp"

#include <utility>

namespace isthmus {

void Bulletin::post(const std::string& topic, std::string text) {
  {
    const std::lock_guard lock(mutex_);
    Topic& entry = topics_[topic];
    if (entry.number > 0 && entry.text == text) return;
    entry = {std::move(text), ++posted_};
  }
  changed_.notify_all();
}

std::optional<std::string> Bulletin::next(Cursor& cursor, std::chrono::milliseconds wait) {
  std::unique_lock lock(mutex_);
  std::string text = news(cursor);
  if (text.empty()) {
    const std::uint64_t seen = posted_;
    changed_.wait_for(lock, wait, [&] { return closed_ || posted_ != seen; });
    text = news(cursor);
  }
  if (closed_) return std::nullopt;
  return text;
}

std::string Bulletin::news(Cursor& cursor) const {
  std::string text;
  for (const auto& [name, topic] : topics_) {
    std::uint64_t& sent = cursor[name];
    if (sent == topic.number) continue;
    sent = topic.number;
    text += "event: " + name + "\ndata: " + topic.text + "\n\n";
  }
  return text;
}

void Bulletin::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

}  // namespace isthmus
