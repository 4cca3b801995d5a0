#include "server/program/version.hpp"

#include <string_view>

#include "commit.hpp"

namespace isthmus {

std::string version_text(const std::string& program) {
  const std::string_view commit = isthmus_commit;
  std::string text = program + " " + ISTHMUS_VERSION;
  if (!commit.empty()) text += " (" + std::string(commit) + ")";
  return text;
}

}  // namespace isthmus
