#pragma once

#include <string>

#include "server/engine/record/map_copy.hpp"
#include "server/output/vector_plan/vector_plan.hpp"

namespace isthmus {

/// The plan as a picture: walls, openings dashed, poles, a scale bar.
std::string plan_svg(const VectorPlan& plan);

/// DXF of AutoCAD R12 in ASCII, metres: LINEs on the layers WALLS and OPENINGS, CIRCLEs on POLES.
std::string plan_dxf(const VectorPlan& plan, const std::string& frame);

/// GeoJSON (RFC 7946): a FeatureCollection of LineStrings (`kind` wall, with `sigma_m` and `views`, or
/// opening) and Points (`kind` pole). Coordinates are metres in the island's own frame by prior arrangement
/// (section 4), not WGS 84, as the foreign member `coordinate_frame` says.
std::string plan_geojson(const VectorPlan& plan, const std::string& frame);

/// Writes island-K-plan.svg, .dxf and .geojson of the K-th island into a directory that is there.
void write_plan_files(const VectorPlan& plan, std::size_t island, const std::string& directory);

/// Writes them for each island of a map; each
/// file is complete or absent. Throws std::runtime_error naming the file and the reason.
void write_plans(const MapCopy& map, const std::string& directory, const PlanOptions& options = {});

}  // namespace isthmus
