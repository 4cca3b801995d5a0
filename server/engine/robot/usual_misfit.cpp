#include "server/engine/robot/usual_misfit.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {

void UsualMisfit::learn(double score, const UsualMisfitOptions& options) {
  scans_ = std::min(scans_ + 1, options.memory_scans);
  mean_ += (1 - score - mean_) / scans_;
}

double UsualMisfit::least_score(const UsualMisfitOptions& options) const {
  return 1 + std::log(options.rare_share) * mean_;
}

}  // namespace isthmus
