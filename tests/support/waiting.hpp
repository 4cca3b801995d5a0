#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace isthmus {

/// Waits until something another thread does has happened; false where it has not after the limit, which is
/// far beyond what a loaded machine needs.
inline bool happens(const std::function<bool()>& what,
                    std::chrono::milliseconds limit = std::chrono::seconds(30)) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!what()) {
    if (std::chrono::steady_clock::now() > end) return what();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace isthmus
