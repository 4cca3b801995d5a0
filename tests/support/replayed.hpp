#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "server/engine/engine.hpp"
#include "server/wire/journal/drop_record.hpp"
#include "tests/support/log_files.hpp"

namespace isthmus {

/// The map that the journal's events make, and how many there are.
struct Replayed {
  std::string sha256;
  std::size_t events = 0;
  std::map<DropReason, std::int64_t> dropped = {};  ///< messages, and why
};

inline Replayed replay_of(const std::string& journal) {
  Engine engine;
  const LogContent content = read_log(journal);
  for (const Message& message : content.messages) {
    if (const auto drops = read_drops(message)) {
      count_drops(engine, *drops);
      continue;
    }
    const Decoded decoded =
        decode(channels_of(engine.configuration()), message.channel, message.bytes, message.utime);
    EXPECT_TRUE(decoded.event) << message.channel << " " << word(decoded.reason);
    if (decoded.event) engine.handle(*decoded.event);
  }
  engine.finish();
  const MapCopy map = engine.copy();
  return {map_sha256(map), content.messages.size(), map.counters.dropped};
}

}  // namespace isthmus
