#pragma once

#include <string>

#include "tests/support/published.hpp"

namespace isthmus {

/// A robot's message into a server's inbox, as whoever receives puts it there.
inline void push(Inbox& inbox, const std::string& robot, const Message& message) {
  inbox.push(robot, message.channel.ends_with("_SCAN"), message.utime, message.channel, message.bytes,
             message.signature);
}

/// Quick ones, with a journal.
inline LiveOptions journalled(const std::string& directory) {
  LiveOptions options = quick_options();
  options.journal_directory = directory;
  return options;
}

}  // namespace isthmus
