#pragma once

#include <string_view>

namespace isthmus {

/// A file of the page, built into the program (embed.cmake).
struct Asset {
  std::string_view path;  ///< "/page.js"
  std::string_view content_type;
  std::string_view bytes;
};

/// The file at a path, of which "/" is index.html; nullptr where there is none.
const Asset* find_asset(std::string_view path);

}  // namespace isthmus
