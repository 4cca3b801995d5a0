#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "server/wire/journal/event_log.hpp"
#include "server/wire/journal/frames/journal_entry.hpp"

namespace isthmus {

inline std::vector<std::uint8_t> read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> bytes;
  for (char c = 0; file.get(c);) bytes.push_back(static_cast<std::uint8_t>(c));
  return bytes;
}

/// The content of all files of a directory, by their names.
inline std::map<std::string, std::vector<std::uint8_t>> files_of(const std::string& directory) {
  std::map<std::string, std::vector<std::uint8_t>> files;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(directory))
    files[entry.path().filename().string()] = read_bytes(entry.path().string());
  return files;
}

inline void write_bytes(const std::string& path, std::span<const std::uint8_t> bytes) {
  std::ofstream file(path, std::ios::binary);
  for (const std::uint8_t byte : bytes) file.put(static_cast<char>(byte));
}

inline void write_log(const std::string& path, const std::vector<Message>& messages) {
  EventLogWriter writer(path);
  for (const Message& message : messages) writer.write(message);
  writer.finish();
}

struct LogContent {
  std::vector<Message> messages;
  std::int64_t skipped = 0;
  std::int64_t missing = 0;
  std::vector<std::string> warnings;
};

/// A log file or journal directory, read to its end.
inline LogContent read_log(const std::string& path) {
  EventLogReader reader(path);
  LogContent content;
  while (auto message = reader.next()) content.messages.push_back(*message);
  content.skipped = reader.skipped_bytes();
  content.missing = reader.missing_events();
  content.warnings = reader.take_warnings();
  return content;
}

inline bool same(const Message& a, const Message& b) {
  return a.utime == b.utime && a.channel == b.channel && a.bytes == b.bytes;
}

/// Frame k of a log of these messages occupies the bytes [ends[k - 1], ends[k]).
inline std::vector<std::size_t> frame_ends(const std::vector<Message>& messages) {
  std::vector<std::size_t> ends;
  std::size_t end = 0;
  for (const Message& message : messages) {
    end += 28 + message.channel.size() + message.bytes.size();
    ends.push_back(end);
  }
  return ends;
}

/// The same of a journal's first segment: entry k with its event, where each is of one frame.
inline std::vector<std::size_t> entry_ends(const std::vector<Message>& messages) {
  std::vector<std::size_t> ends = frame_ends(messages);
  std::size_t before = segment_header_bytes;
  for (std::size_t& end : ends) end += (before += entry_frame_bytes);
  return ends;
}

}  // namespace isthmus
