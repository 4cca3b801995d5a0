#pragma once

#include <string>

#include "isthmus/request_t.hpp"

namespace isthmus::testing {

/// A question that is asked from where a robot is.
inline request_t question_of(const std::string& kind, const std::string& robot) {
  request_t request{};
  request.utime = 5;
  request.id = 1;
  request.asker = robot;
  request.kind = kind;
  request.timeout_s = 30;
  request.robot = robot;
  request.radius_m = 0.2;
  request.clearance_m = 0.1;
  return request;
}

}  // namespace isthmus::testing
