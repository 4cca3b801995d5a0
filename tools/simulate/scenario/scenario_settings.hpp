#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "server/engine/input/settings.hpp"

namespace isthmus {

/// Reads a TOML file. Throws std::runtime_error "FILE:LINE: reason".
Setting read_toml(const std::string& file);

/// What the place of a setting begins with that stands on the command line.
constexpr const char* override_mark = "--set ";

/// Applies "key.path=value", the value in TOML's notation or a bare string, over what the file says.
void override_setting(Setting& root, const std::string& assignment);

Eigen::Vector2d as_point(const Setting& setting);
/// `what` is what an error says was expected.
std::vector<Eigen::Vector2d> as_points(const Setting& setting, std::size_t at_least, const std::string& what);

}  // namespace isthmus
