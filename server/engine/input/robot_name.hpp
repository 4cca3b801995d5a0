#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace isthmus {

/// Names compare without case; inside, and in outputs, they are upper case. ASCII only, whatever the locale.
inline std::string upper_case(std::string_view text) {
  std::string upper(text);
  for (char& c : upper) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return upper;
}

/// Whether an upper-case name can be a robot's: it becomes part of channel names (63 characters at most) and
/// of file names, so only A-Z, 0-9, '_' and '-', beginning with a letter or digit. ISTHMUS is the server's
/// own.
inline bool is_robot_name(std::string_view upper) {
  const auto alphanumeric = [](char c) { return (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); };
  return !upper.empty() && upper.size() <= 48 && upper != "ISTHMUS" && alphanumeric(upper.front()) &&
         std::all_of(upper.begin(), upper.end(),
                     [&](char c) { return alphanumeric(c) || c == '_' || c == '-'; });
}

}  // namespace isthmus
