#pragma once

#include <string>

#include "tools/evaluate/report.hpp"

namespace isthmus {

/// Why nothing can be concluded from an evaluation: a fit without a solution, or truth that nothing on the
/// map matches, as when it is another run's; empty: something can.
std::string failure_of(const Evaluation& evaluation);

}  // namespace isthmus
