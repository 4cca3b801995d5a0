#include "server/wire/questions/low_priority.hpp"

#include <sys/resource.h>
#include <unistd.h>

namespace isthmus {
namespace {

void be_nice(int by) { ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), by); }

}  // namespace

void take_low_priority() {
  constexpr int lowest = 19;
  be_nice(lowest);
}

void take_lower_priority() {
  constexpr int lower = 5;
  be_nice(lower);
}

}  // namespace isthmus
