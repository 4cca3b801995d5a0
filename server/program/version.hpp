#pragma once

#include <string>

namespace isthmus {

/// "isthmus-replay 0.1.0 (21cbe3b0d8f1)": with the commit that the program was built of, and a "+" behind it
/// where the sources had been changed; without one where they came without their history.
std::string version_text(const std::string& program);

}  // namespace isthmus
