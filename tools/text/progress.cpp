#include "tools/text/progress.hpp"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace isthmus {

Progress::Progress(std::string label) : label_(std::move(label)), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::update(double share) {
  if (is_due()) show(std::to_string(static_cast<int>(100 * share)) + " %");
}

void Progress::say(const std::string& what) {
  if (is_due()) show(what);
}

bool Progress::is_due() {
  if (!terminal_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::milliseconds(100)) return false;
  last_ = now;
  return true;
}

void Progress::show(const std::string& what) {
  std::fprintf(stderr, "\r%s %s\033[K", label_.c_str(), what.c_str());
  std::fflush(stderr);
}

}  // namespace isthmus
