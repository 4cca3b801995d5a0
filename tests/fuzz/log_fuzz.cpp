#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "server/wire/journal/event_log.hpp"

/// Input: a log file. Whatever it is, it is refused with an error, or read to its end with every byte either
/// in an event or counted as skipped.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int file = memfd_create("log", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) return 0;
  try {
    isthmus::EventLogReader reader(path);
    std::size_t bytes = 0;
    while (const auto message = reader.next()) bytes += 28 + message->channel.size() + message->bytes.size();
    if (bytes + static_cast<std::size_t>(reader.skipped_bytes()) != size) std::abort();
  } catch (const std::runtime_error&) {
  }
  return 0;
}
