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
  if (!terminal_ || ++calls_ % 64 != 1) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < std::chrono::milliseconds(100)) return;
  last_ = now;
  std::fprintf(stderr, "\r%s %3.0f %%\033[K", label_.c_str(), 100 * share);
  std::fflush(stderr);
}

}  // namespace isthmus
