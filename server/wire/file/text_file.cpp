#include "server/wire/file/text_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>

#include "server/engine/record/uninterrupted.hpp"
#include "server/wire/file/file_bytes.hpp"

namespace isthmus {
namespace {

std::runtime_error unreadable(const std::string& path, int error) {
  return std::runtime_error(path + ": cannot be read: " + errno_text(error));
}

}  // namespace

std::string read_text_file(const std::string& path) {
  // Not waiting for a pipe's other end.
  const FileHandle file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0) throw unreadable(path, errno);
  if (S_ISDIR(status.st_mode)) throw std::runtime_error(path + ": is a directory; give the file");
  if (!S_ISREG(status.st_mode)) throw std::runtime_error(path + ": is no regular file");
  std::string text;
  std::array<char, 65'536> bytes;
  while (true) {
    const ssize_t size = uninterrupted([&] { return ::read(file.get(), bytes.data(), bytes.size()); });
    if (size < 0) throw unreadable(path, errno);
    if (size == 0) return text;
    text.append(bytes.data(), static_cast<std::size_t>(size));
  }
}

std::string check_key_file(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) throw unreadable(path, errno);
  const std::string remedy = "chmod 600 " + path;
  if ((status.st_mode & S_IWOTH) != 0)
    throw std::runtime_error(path + ": holds keys, and anybody may write it: " + remedy);
  return (status.st_mode & S_IROTH) != 0 ? path + ": holds keys, and anybody may read it: " + remedy : "";
}

}  // namespace isthmus
