#include "server/wire/questions/low_priority.hpp"

#include <sys/resource.h>
#include <unistd.h>

namespace isthmus {

void take_low_priority() {
  constexpr int lowest = 19;
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), lowest);
}

}  // namespace isthmus
