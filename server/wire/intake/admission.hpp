#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>

#include "server/engine/input/drop_reason.hpp"
#include "server/engine/record/map_copy.hpp"

namespace isthmus {

struct AdmissionLimits {
  std::size_t robots = 256;
  std::size_t tags = 10'000;  ///< declared ones
};

/// How many robots and tags a map is for: anybody can make up more. Those that are known stay, more are
/// refused before they are journalled, so that the engine remains a function of the journal.
class Admission {
 public:
  explicit Admission(AdmissionLimits limits = {}) : limits_(limits) {}

  /// Why an event is refused; `none`: it is not, and whom it introduces is known from now on.
  DropReason admit(const Event& event);

  /// The robots and tags of a map that was made before.
  void know(const MapCopy& map);

 private:
  AdmissionLimits limits_;
  std::set<std::string> robots_;
  std::set<std::int32_t> tags_;
};

}  // namespace isthmus
