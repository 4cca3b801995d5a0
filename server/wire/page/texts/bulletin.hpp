#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace isthmus {

/// What is sent to viewers, by topic: the newest text of each, and no queue. A viewer that reads slowly
/// misses what was in between, and costs the others nothing. Any thread.
class Bulletin {
 public:
  /// Which texts a viewer has.
  using Cursor = std::map<std::string, std::uint64_t>;

  /// Nothing is sent where it is the text there was. It must be one line.
  void post(const std::string& topic, std::string text);

  /// The texts that the viewer has not got yet, as server-sent events (WHATWG HTML, 9.2); empty where there
  /// is none until `wait` is over; nothing once closed.
  std::optional<std::string> next(Cursor& cursor, std::chrono::milliseconds wait);

  void close();

 private:
  struct Topic {
    std::string text;
    std::uint64_t number = 0;
  };

  std::string news(Cursor& cursor) const;

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, Topic> topics_;
  std::uint64_t posted_ = 0;
  bool closed_ = false;
};

}  // namespace isthmus
