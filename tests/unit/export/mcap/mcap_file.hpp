#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace isthmus::testing {

/// An MCAP file as mcap.dev/spec has it, read by its index as players do: footer, summary, and from there
/// each chunk and each message index. Throws std::runtime_error with what is wrong, each CRC, length and
/// offset included. All chunks must be compressed by zstd; attachments and metadata are not known.
struct McapFile {
  struct Schema {
    std::string name, encoding, text;
  };
  struct Channel {
    std::uint16_t schema = 0;
    std::string topic, encoding;
  };
  struct Message {
    std::uint16_t channel = 0;
    std::uint32_t sequence = 0;
    std::uint64_t log_time_ns = 0;
    std::string data;
  };
  struct Chunk {
    std::uint64_t first_ns = 0, last_ns = 0;
    std::size_t messages = 0;
    std::size_t bytes = 0;  ///< as they are in the file, compressed
  };

  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;
  std::vector<Chunk> chunks;
  std::vector<Message> messages;  ///< chunk by chunk, as they are in the file
  std::uint64_t counted_messages = 0, first_ns = 0, last_ns = 0;

  std::vector<Message> of_topic(std::string_view topic) const {
    std::vector<Message> all;
    for (const Message& message : messages)
      if (channels.at(message.channel).topic == topic) all.push_back(message);
    return all;
  }
};

McapFile read_mcap(const std::string& bytes);

}  // namespace isthmus::testing
