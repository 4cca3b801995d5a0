#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "server/wire/journal/journal.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {

/// A journal of two robots in a box; of 150 rounds it has some ten segments.
inline std::string write_team_journal(const TemporaryDirectory& directory, int rounds = 150) {
  std::string path = directory / "journal";
  JournalOptions options;
  options.segment_bytes = 30'000;
  Journal journal(path, options);
  const BoxRoomRobot robots[] = {BoxRoomRobot("R1"), BoxRoomRobot("R2")};
  journal.append(encode({1, ConfigurationEvent{}}));
  for (const BoxRoomRobot& robot : robots) journal.append(robot.introduction());
  for (int round = 0; round < rounds; ++round) {
    for (const BoxRoomRobot& robot : robots)
      for (const Message& message : robot.round(round)) journal.append(message);
  }
  return path;
}

/// In the middle of a file.
inline void flip_a_bit(const std::string& path) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  const auto middle = static_cast<std::streamoff>(std::filesystem::file_size(path) / 2);
  file.seekg(middle);
  const char byte = static_cast<char>(file.get() ^ 1);
  file.seekp(middle);
  file.put(byte);
}

}  // namespace isthmus
