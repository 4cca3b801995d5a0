#include "tools/text/words.hpp"

#include <cmath>

#include "tools/text/numbers.hpp"

namespace isthmus {

bool WordReader::next() {
  while (const auto line = lines_.next()) {
    split_words(*line, words_);
    if (!words_.empty() && words_[0].front() != '#') return true;
  }
  words_.clear();
  return false;
}

double WordReader::number(std::size_t index) const {
  const auto value = parse_double(words_[index]);
  if (!value || !std::isfinite(*value)) fail("'" + std::string(words_[index]) + "' is not a finite number");
  return *value;
}

std::int64_t WordReader::integer(std::size_t index) const {
  const auto value = parse_integer(words_[index]);
  if (!value) fail("'" + std::string(words_[index]) + "' is not an integer");
  return *value;
}

void WordReader::expect_words(std::size_t count) const {
  if (words_.size() != count)
    fail("expected " + std::to_string(count) + " fields, found " + std::to_string(words_.size()));
}

void WordReader::fail(const std::string& reason) const {
  throw FileError(lines_.file(), lines_.number(), reason);
}

}  // namespace isthmus
