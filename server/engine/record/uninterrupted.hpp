#pragma once

#include <cerrno>

namespace isthmus {

/// A system call made again for as long as signals interrupt it: what it returns then, below 0 with errno for
/// an error.
template <class Call>
auto uninterrupted(const Call& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

}  // namespace isthmus
