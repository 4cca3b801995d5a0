#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace isthmus {

/// How many letters must be put in, taken out, replaced, or exchanged with their neighbour to make one word
/// of the other (Damerau 1964; each letter in one exchange at most).
std::size_t letters_apart(std::string_view a, std::string_view b);

/// The word that was meant, of those there are: the nearest, and of equally near ones the first. Nothing
/// where more than a third of what was typed is wrong.
std::optional<std::string> nearest_word(std::string_view typed, const std::vector<std::string>& words);

/// "; did you mean 'office'?", or nothing where no word is near.
std::string did_you_mean(std::string_view typed, const std::vector<std::string>& words);

}  // namespace isthmus
