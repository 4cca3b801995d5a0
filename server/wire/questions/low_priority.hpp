#pragma once

namespace isthmus {

/// This thread, and those it starts, give way to the others of the process (nice 19, which Linux has of each
/// thread). Where it is not granted they run as they are.
void take_low_priority();
/// The same, but not by so much (nice 5): robots wait for what it does, on a busy machine too.
void take_lower_priority();

}  // namespace isthmus
