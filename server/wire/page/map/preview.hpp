#pragma once

#include <string>

#include "server/wire/page/map/shown_map.hpp"

namespace isthmus {

/// A closure's evidence, and what its withdrawal would change, as a line of JSON: its relations by origin,
/// its sightings by verdict, the relations that depend on it, and how many patches each part of its island
/// has without its own relations, and without those that depend on it too. What depends on it is judged again
/// by a withdrawal: what happens lies between the two. Empty where there is no such closure.
std::string closure_preview(const ShownMap& shown, ClosureId closure);

/// What dropping a robot would take out: its patches, their relations, and how many closures of each kind
/// have some of these; zeros where it has none. And the patches that are left out already, which allowing it
/// would bring back.
std::string robot_preview(const ShownMap& shown, const std::string& robot);

}  // namespace isthmus
