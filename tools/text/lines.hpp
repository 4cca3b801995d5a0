#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace isthmus {

/// An error in a text file: "file:line: reason", or "file: reason" for line 0.
class FileError : public std::runtime_error {
 public:
  FileError(const std::string& file, long line, const std::string& reason);
};

/// The file ends before its compressed stream does.
class TruncatedFile : public FileError {
 public:
  using FileError::FileError;
};

/// Reads a text file line by line, plain or gz.
class LineReader {
 public:
  /// Throws FileError where the file cannot be opened.
  explicit LineReader(const std::string& file);
  ~LineReader();
  LineReader(LineReader&&) noexcept;
  LineReader& operator=(LineReader&&) noexcept;

  /// The next line without its end (LF or CR LF), valid until the next call; nothing at the end. Throws
  /// FileError for damage, for lines over 16 MB, and (TruncatedFile) for a gz cut short.
  std::optional<std::string_view> next();

  const std::string& file() const;
  long number() const;      ///< of the last line returned, counted from 1
  double progress() const;  ///< share of the file read, 0 to 1

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isthmus
