#pragma once

#include <cstdlib>
#include <string>

namespace isthmus {

/// Where recorded data lies; none of it is part of the repository.
inline std::string data_directory() {
  const char* given = std::getenv("ISTHMUS_DATA");
  return given != nullptr ? given : "../shared/data";
}

}  // namespace isthmus
