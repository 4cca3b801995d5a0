// A CARMEN log and a sightings table of any bytes: events or an error that names the file, nothing else.
// The first byte says which of the two the rest is, and whether bad lines are skipped.

#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tools/import/import.hpp"
#include "tools/text/lines.hpp"

namespace {

using namespace isthmus;

/// Files of this process, overwritten by every input and removed at exit.
class Files {
 public:
  Files()
      : directory_(std::filesystem::temp_directory_path() / ("isthmus-fuzz-" + std::to_string(getpid()))) {
    std::filesystem::create_directories(directory_);
  }
  ~Files() {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  std::string write(const char* name, const char* data, std::size_t size) const {
    const std::string file = (directory_ / name).string();
    std::ofstream(file, std::ios::binary).write(data, static_cast<std::streamsize>(size));
    return file;
  }

 private:
  std::filesystem::path directory_;
};

void require(bool holds) {
  if (!holds) std::abort();
}

void check(const std::vector<Event>& events) {
  std::int64_t last = events.empty() ? 0 : events.front().receive_utime;
  for (const Event& event : events) {
    require(event.receive_utime >= last);
    last = event.receive_utime;
    if (const auto* odometry = std::get_if<OdometryEvent>(&event.body))
      require(is_finite(odometry->odom_from_robot));
    if (const auto* sighting = std::get_if<SightingEvent>(&event.body)) {
      require(std::isfinite(sighting->range_m) && std::isfinite(sighting->bearing_rad));
      require(sighting->range_sigma_m > 0 && sighting->bearing_sigma_rad > 0 && sighting->barcode >= 0);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Files files;
  static const std::string plain_log = "ODOM 0 0 0 0 0 0 1.5 host 1.5\n";
  if (size == 0) return 0;
  const bool sightings = (data[0] & 1U) != 0;
  const char* text = reinterpret_cast<const char*>(data + 1);
  CarmenImport what;
  what.skip_bad_lines = (data[0] & 2U) != 0;
  what.logs = {{"R1", sightings ? files.write("plain.clf", plain_log.data(), plain_log.size())
                                : files.write("log.clf", text, size - 1)}};
  if (sightings) what.sightings_csv = files.write("sightings.csv", text, size - 1);
  try {
    check(import_carmen(what));
  } catch (const FileError&) {
  }
  return 0;
}
