#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "server/wire/journal.hpp"
#include "server/wire/recovery.hpp"

/// Input: the last segment of a journal, as a crash or a bad disk left it. Whatever it is, the journal goes
/// on behind it, is recovered, and a second opening finds nothing more to cut.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isthmus;
  namespace fs = std::filesystem;
  static const fs::path directory = fs::temp_directory_path() / ("isthmus-fuzz-" + std::to_string(getpid()));
  fs::remove_all(directory);
  fs::create_directory(directory);
  std::ofstream(directory / "journal-000001.lcm", std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  {
    Journal journal(directory.string());
    journal.count_signatures();
    if (!journal.append(encode({1, TickEvent{}}))) std::abort();
  }
  if (Journal(directory.string()).torn_bytes() != 0) std::abort();
  try {
    Recovery recovery(directory.string());
    if (!recovery.has_events()) std::abort();
    ServedMap map = recovery.begin();
    for (int event = 0; event < 200 && recovery.step(map); ++event) {
    }
  } catch (const std::runtime_error&) {  // its configuration is wrong
  }
  fs::remove_all(directory);
  return 0;
}
