#pragma once

#include <fcntl.h>
#include <sys/resource.h>

#include <algorithm>

#include "server/wire/file/file_bytes.hpp"

namespace isthmus {

/// The descriptor that this process gets next.
inline rlim_t next_descriptor() {
  const FileHandle next(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  return static_cast<rlim_t>(next.get());
}

/// Lets this process have descriptors below `most` only, for a while.
class DescriptorLimit {
 public:
  explicit DescriptorLimit(rlim_t most) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit wanted{std::min(most, before_.rlim_max), before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &wanted);
  }
  ~DescriptorLimit() { ::setrlimit(RLIMIT_NOFILE, &before_); }

 private:
  rlimit before_{};
};

}  // namespace isthmus
