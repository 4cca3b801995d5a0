#pragma once

#include <cstdint>
#include <string>

namespace isthmus {

/// A part of a log that is skipped because it is damaged or missing.
struct LogDamage {
  std::string file;
  std::int64_t offset = 0;
  std::int64_t bytes = 0;
  std::int64_t missing = 0;  ///< events that a journal lacks there; 0: none, or it cannot be known
};

/// "a.lcm: 512 damaged bytes passed over at offset 9000; events missing: 2"
inline std::string text_of(const LogDamage& damage) {
  std::string text = damage.file + ": ";
  if (damage.bytes > 0) text += std::to_string(damage.bytes) + " damaged bytes passed over ";
  if (damage.bytes == 0) text += "something is gone ";
  text += "at offset " + std::to_string(damage.offset);
  if (damage.missing > 0) text += "; events missing: " + std::to_string(damage.missing);
  return text;
}

/// "a.lcm: 9000 damaged bytes passed over in 12 other places; events missing: 15"
inline std::string text_of_more(const LogDamage& sum, std::int64_t places) {
  return sum.file + ": " + std::to_string(sum.bytes) + " damaged bytes passed over in " +
         std::to_string(places) + " other places; events missing: " + std::to_string(sum.missing);
}

}  // namespace isthmus
