#pragma once

#include <cerrno>

namespace isthmus {

/// Repeats a system call while signals interrupt it. Returns its result; below 0 with errno for
/// an error.
template <class Call>
auto uninterrupted(const Call& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

}  // namespace isthmus
