#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "server/engine/engine.hpp"
#include "server/wire/journal/event_log.hpp"

/// Input: a log file. Whatever its messages are and in whatever order, the engine takes them or counts them,
/// and finishes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int file = memfd_create("events", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) return 0;
  try {
    isthmus::EventLogReader reader(path);
    isthmus::Engine engine;
    isthmus::ChannelNames channels;
    while (const auto message = reader.next()) {
      const auto decoded = isthmus::decode(channels, message->channel, message->bytes, message->utime);
      if (!decoded.event) continue;
      engine.handle(*decoded.event);
      if (std::holds_alternative<isthmus::ConfigurationEvent>(decoded.event->body))
        channels = isthmus::channels_of(engine.configuration());
    }
    engine.finish();
    engine.copy();
  } catch (const std::runtime_error&) {
    // It is no log.
  }
  return 0;
}
