#pragma once

#include <cstdint>
#include <string>

namespace isthmus {

/// The shortest text that reads back as the same double: "0.1", "inf", "nan".
std::string number(double value);
/// With so many digits after the point; never "-0.000".
std::string fixed(double value, int decimals);
/// Microseconds as seconds with six decimals, exactly.
std::string seconds(std::int64_t utime);

}  // namespace isthmus
