#pragma once

#include <string>
#include <string_view>

namespace isthmus {

/// A file that is complete or absent: written under a temporary name beside it, synced and renamed by
/// `commit`. Without a commit nothing is left. Errors are std::runtime_error naming the file and the reason.
class AtomicFile {
 public:
  explicit AtomicFile(std::string path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::string_view bytes);
  void commit();

 private:
  void write_buffer();
  [[noreturn]] void fail(const char* action) const;

  std::string path_;
  std::string temporary_path_;
  std::string buffer_;
  int file_ = -1;
};

/// Makes a directory and those above it. Throws std::runtime_error naming it and the reason.
void make_directory(const std::string& directory);

}  // namespace isthmus
