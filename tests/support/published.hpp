#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/wire/live/live_server.hpp"

namespace isthmus {

/// What the server published, by channel.
class Published {
 public:
  Publish sink() {
    return [this](const std::string& channel, const std::vector<std::uint8_t>& bytes) {
      const std::lock_guard lock(mutex_);
      messages_[channel].push_back(bytes);
    };
  }
  template <class T>
  std::vector<T> of(const std::string& channel) {
    const std::lock_guard lock(mutex_);
    std::vector<T> messages;
    for (const auto& bytes : messages_[channel]) {
      T message;
      const int size = static_cast<int>(bytes.size());
      EXPECT_EQ(message.decode(bytes.data(), 0, size), size) << channel;
      messages.push_back(message);
    }
    return messages;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::vector<std::vector<std::uint8_t>>> messages_;
};

/// Everything at once, on a clock of its own.
inline LiveOptions quick_options() {
  LiveOptions options;
  auto now = std::make_shared<std::atomic<std::int64_t>>(1'000'000'000);
  options.clock = std::make_shared<EventClock>([now] { return now->load(); }, [now] { return *now += 1000; });
  options.status_interval = std::chrono::milliseconds(20);
  options.tick_interval = std::chrono::milliseconds(5);
  options.map.grid_interval = std::chrono::milliseconds(0);
  options.map.chunk_pause = std::chrono::milliseconds(0);
  return options;
}

}  // namespace isthmus
