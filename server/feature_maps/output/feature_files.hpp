#pragma once

#include <string>

#include "server/feature_maps/mapper/feature_mapper.hpp"
#include "server/output/output.hpp"

namespace isthmus {

/// SHA-256, in hex, over all features with their covariances and all robots, numbers as they read back.
std::string map_sha256(const FeatureMaps& maps);

/// `island,id,kind,barcode,ax_m,ay_m,bx_m,by_m,radius_m,seen,` and the covariance of x_p (m_space), its upper
/// triangle by rows; nan for what is not known or not of that kind.
std::string features_csv(const FeatureMaps& maps);

/// Writes features.csv, trajectories, robots.csv, sightings.csv, tags.csv, report.json and each island's plan
/// into a directory, made where missing; each file is complete or absent. Throws std::runtime_error naming
/// the file and the reason.
void write_outputs(const FeatureMaps& maps, const RunCost& cost, const std::string& directory);

}  // namespace isthmus
