#include "server/program/new_output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace isthmus {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& what) {
  throw std::runtime_error(what + "; --force writes over it");
}

/// By writing something: permissions do not tell of a disk that is mounted to be read only.
void check_writable(const std::string& directory) {
  const std::string probe = directory + "/.isthmus-" + std::to_string(::getpid());
  const int file = ::open(probe.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) throw std::runtime_error(directory + ": cannot be written: " + std::strerror(errno));
  ::close(file);
  ::unlink(probe.c_str());
}

}  // namespace

void check_new_file(const std::string& file, bool force) {
  std::error_code none;
  // A device or a pipe holds nothing.
  if (!force && fs::is_regular_file(file, none) && fs::file_size(file, none) > 0)
    refuse(file + " exists already");
}

void check_new_directory(const std::string& directory, bool force) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (error) throw std::runtime_error(directory + ": cannot be made: " + error.message());
  if (!force && fs::exists(directory + "/report.json", error)) refuse(directory + " holds a map already");
  check_writable(directory);
}

void check_new_files_in(const std::string& directory, const std::vector<std::string>& endings, bool force) {
  std::error_code none;
  if (force || !fs::is_directory(directory, none)) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory))
    if (std::ranges::any_of(endings, [name = entry.path().filename().string()](const std::string& ending) {
          return name.ends_with(ending);
        }))
      check_new_file(entry.path().string(), force);
}

}  // namespace isthmus
