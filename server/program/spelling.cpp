#include "server/program/spelling.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace isthmus {
namespace {

/// So many letters of a word to each that is wrong: else it is another word.
constexpr std::size_t letters_to_a_slip = 3;

}  // namespace

std::size_t letters_apart(std::string_view a, std::string_view b) {
  // Rows of the table over prefixes of a; `before` and `last` are of one and two letters less.
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  std::vector<std::size_t> last, before;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::move(last);
    last = std::move(row);
    row.assign(b.size() + 1, i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t wrong = a[i - 1] == b[j - 1] ? 0 : 1;
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + wrong});
      const bool exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (exchanged) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row.back();
}

std::optional<std::string> nearest_word(std::string_view typed, const std::vector<std::string>& words) {
  const std::string* nearest = nullptr;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const std::string& word : words) {
    const std::size_t apart = letters_apart(typed, word);
    if (apart < least) nearest = &word;
    least = std::min(least, apart);
  }
  if (nearest == nullptr || letters_to_a_slip * least > std::max(typed.size(), nearest->size()))
    return std::nullopt;
  return *nearest;
}

std::string did_you_mean(std::string_view typed, const std::vector<std::string>& words) {
  const std::optional<std::string> word = nearest_word(typed, words);
  return word ? "; did you mean '" + *word + "'?" : "";
}

}  // namespace isthmus
