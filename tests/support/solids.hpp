#pragma once

#include <vector>

#include "patches/polysolid.hpp"

namespace isthmus::testing {

inline double area_m2(const Polysolid& solid) {
  double area = 0;
  for (const PolygonWithHoles& polygon : solid.polygons()) {
    area += signed_area_m2(polygon.outer);
    for (const Ring& hole : polygon.holes) area += signed_area_m2(hole);
  }
  return area;
}

inline Polysolid united(const std::vector<Polysolid>& parts) {
  std::vector<PolygonWithHoles> polygons;
  for (const Polysolid& part : parts)
    polygons.insert(polygons.end(), part.polygons().begin(), part.polygons().end());
  return Polysolid(std::move(polygons));
}

/// Of what both hold.
inline double shared_area_m2(const Polysolid& a, const Polysolid& b) {
  return area_m2(a) + area_m2(b) - area_m2(united({a, b}));
}

}  // namespace isthmus::testing
