#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace isthmus {

/// What printf would print, however long it is.
template <class... Values>
std::string printed(const char* format, Values... values) {
  const int length = std::snprintf(nullptr, 0, format, values...);
  if (length <= 0) return "";
  std::string text(static_cast<std::size_t>(length), '\0');
  std::snprintf(text.data(), text.size() + 1, format, values...);
  return text;
}

template <class... Values>
std::string printed_line(const char* format, Values... values) {
  return printed(format, values...) + '\n';
}

}  // namespace isthmus
