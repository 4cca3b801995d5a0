#pragma once

#include <array>

#include "server/wire/message/byte_check.hpp"

namespace isthmus::members {

/// What many messages have.
inline constexpr Member number = fixed(8);   ///< int64_t, double
inline constexpr Member integer = fixed(4);  ///< int32_t, float
inline constexpr Member name = text(64);
inline constexpr Member pose_values = fixed(7 * 8);  ///< a translation and a quaternion
inline constexpr std::array path_pose = {integer, pose_values};

}  // namespace isthmus::members
