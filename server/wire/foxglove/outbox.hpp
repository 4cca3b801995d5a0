#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

namespace isthmus::foxglove {

using Text = std::shared_ptr<const std::string>;

/// What waits to be sent to one viewer, bounded: one that reads slowly misses messages, and costs no more
/// memory than this.
class Outbox {
 public:
  /// Of what is waiting.
  struct Limits {
    std::size_t stream_messages = 100;          ///< of each channel whose messages all count
    std::size_t data_bytes = 32 * 1024 * 1024;  ///< beyond, new messages are left out
    std::size_t control_bytes = 8 * 1024 * 1024;
  };
  struct Item {
    bool is_data = false;
    std::uint32_t channel = 0;
    std::string head;  ///< of data
    Text body;
  };

  explicit Outbox(Limits limits) : limits_(limits) {}

  /// Must come: what channels there are. False: so much waits that the viewer cannot be helped.
  bool add_control(std::string text);
  /// Takes the place of the channel's message that waits.
  void add_newest(std::uint32_t channel, std::string head, Text body);
  /// The oldest of the channel goes where too many wait.
  void add_to_stream(std::uint32_t channel, std::string head, Text body);
  /// No more of a channel.
  void forget(std::uint32_t channel);

  std::optional<Item> next();
  std::int64_t left_out() const { return left_out_; }

 private:
  void add(std::uint32_t channel, std::string head, Text body);

  Limits limits_;
  std::deque<Item> waiting_;
  std::size_t data_bytes_ = 0;
  std::size_t control_bytes_ = 0;
  std::int64_t left_out_ = 0;
};

}  // namespace isthmus::foxglove
