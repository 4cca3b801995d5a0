#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tools/text/lines.hpp"

namespace isthmus {

/// Reads a text file of words between blanks, a line at a time; passes over empty lines and comments (#).
class WordReader {
 public:
  /// Throws FileError where the file cannot be opened.
  explicit WordReader(const std::string& file) : lines_(file) {}

  /// The next line with a word in it; false at the end. Throws as LineReader::next does.
  bool next();

  std::size_t size() const { return words_.size(); }
  /// Valid until the next line.
  std::string_view word(std::size_t index) const { return words_[index]; }

  /// These throw FileError, which names the line: for a word that is not a finite number or no integer, for
  /// another count of words, and for the reason given.
  double number(std::size_t index) const;
  std::int64_t integer(std::size_t index) const;
  void expect_words(std::size_t count) const;
  [[noreturn]] void fail(const std::string& reason) const;

  long line() const { return lines_.number(); }

 private:
  LineReader lines_;
  std::vector<std::string_view> words_;
};

}  // namespace isthmus
