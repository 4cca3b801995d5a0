#include "tools/text/lines.hpp"

#include <sys/stat.h>
#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <vector>

namespace isthmus {
namespace {

constexpr std::size_t longest_line = 16'000'000;
constexpr unsigned block_size = 1U << 18U;

std::string message(const std::string& file, long line, const std::string& reason) {
  return line > 0 ? file + ":" + std::to_string(line) + ": " + reason : file + ": " + reason;
}

}  // namespace

FileError::FileError(const std::string& file, long line, const std::string& reason)
    : std::runtime_error(message(file, line, reason)) {}

struct LineReader::State {
  struct GzClose {
    void operator()(gzFile_s* opened) const { gzclose(opened); }
  };

  std::string file;
  std::unique_ptr<gzFile_s, GzClose> gz;
  double file_size = 0;
  std::vector<char> buffer;  ///< [begin, end) is read and not yet returned
  std::size_t begin = 0;
  std::size_t end = 0;
  bool at_end = false;
  long number = 0;

  void fill();
  std::string_view take(std::size_t length, std::size_t with_end);
};

void LineReader::State::fill() {
  if (end - begin > longest_line) throw FileError(file, number + 1, "line too long: not a text log");
  if (begin > 0) {
    std::memmove(buffer.data(), buffer.data() + begin, end - begin);
    end -= begin;
    begin = 0;
  }
  if (buffer.size() < end + block_size) buffer.resize(end + block_size);
  const int count = gzread(gz.get(), buffer.data() + end, block_size);
  int error = Z_OK;
  const char* reason = gzerror(gz.get(), &error);
  if (error == Z_BUF_ERROR) throw TruncatedFile(file, number + 1, "truncated gz file");
  if (error == Z_ERRNO) throw FileError(file, 0, std::strerror(errno));
  if (count < 0 || error != Z_OK) {
    throw FileError(file, number + 1, std::string("damaged gz file (") + reason + ")");
  }
  end += static_cast<std::size_t>(count);
  at_end = count == 0;
}

std::string_view LineReader::State::take(std::size_t length, std::size_t with_end) {
  std::string_view line(buffer.data() + begin, length);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  begin += with_end;
  ++number;
  return line;
}

LineReader::LineReader(const std::string& file) : state_(std::make_unique<State>()) {
  state_->file = file;
  state_->gz.reset(gzopen(file.c_str(), "rb"));
  if (!state_->gz) throw FileError(file, 0, std::strerror(errno != 0 ? errno : ENOMEM));
  struct stat status {};
  if (stat(file.c_str(), &status) == 0) state_->file_size = static_cast<double>(status.st_size);
}

LineReader::~LineReader() = default;
LineReader::LineReader(LineReader&&) noexcept = default;
LineReader& LineReader::operator=(LineReader&&) noexcept = default;

std::optional<std::string_view> LineReader::next() {
  State& s = *state_;
  std::size_t searched = 0;
  while (true) {
    const std::size_t length = s.end - s.begin;
    if (length > searched) {
      const char* start = s.buffer.data() + s.begin;
      if (const void* found = std::memchr(start + searched, '\n', length - searched)) {
        const auto at = static_cast<std::size_t>(static_cast<const char*>(found) - start);
        return s.take(at, at + 1);
      }
      searched = length;
    }
    if (!s.at_end) s.fill();
    if (s.at_end && s.end - s.begin == searched) {
      if (searched == 0) return std::nullopt;
      return s.take(searched, searched);
    }
  }
}

const std::string& LineReader::file() const { return state_->file; }
long LineReader::number() const { return state_->number; }

double LineReader::progress() const {
  if (state_->file_size <= 0) return 1;
  return static_cast<double>(gzoffset(state_->gz.get())) / state_->file_size;
}

}  // namespace isthmus
