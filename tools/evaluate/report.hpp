#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/alignment.hpp"
#include "tools/evaluate/landmark_maps.hpp"
#include "tools/evaluate/pose_graph.hpp"
#include "tools/evaluate/relation_error.hpp"

namespace isthmus {

/// What isthmus-evaluate found.
struct Evaluation {
  std::map<std::string, RelationErrors> relations;  ///< by kind
  std::optional<AbsoluteErrors> absolute;
  std::optional<PoseGraphFit> pose_graph;
  std::optional<LandmarkEvaluation> landmarks;
};

std::string to_text(const Evaluation& evaluation);
std::string to_json(const Evaluation& evaluation);

}  // namespace isthmus
