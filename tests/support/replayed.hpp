#pragma once

#include <gtest/gtest.h>

#include <string>

#include "server/engine/engine.hpp"
#include "tests/support/log_files.hpp"

namespace isthmus {

/// The map that the journal's events make, and how many there are.
struct Replayed {
  std::string sha256;
  std::size_t events = 0;
};

inline Replayed replay(const std::string& journal) {
  Engine engine;
  const LogContent content = read_log(journal);
  for (const Message& message : content.messages) {
    const Decoded decoded = decode(engine.configuration(), message.channel, message.bytes, message.utime);
    EXPECT_TRUE(decoded.event) << message.channel << " " << decoded.reason;
    if (decoded.event) engine.handle(*decoded.event);
  }
  engine.finish();
  return {map_sha256(engine.copy()), content.messages.size()};
}

}  // namespace isthmus
