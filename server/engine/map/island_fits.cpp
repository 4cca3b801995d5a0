#include "server/engine/map/island_fits.hpp"

#include <utility>

namespace isthmus {

void IslandFits::map_changed() {
  if (!job_) return;
  requested_.insert(job_->island());
  abandoned_.add(std::move(job_));
}

void IslandFits::advance(Map& map, std::int64_t now_utime, const MapFitOptions& options) {
  if (job_ && job_->advance(now_utime)) {
    const FitJob::Result result = job_->take();
    job_.reset();
    if (result.ok) map.adopt(result.patches, result.poses);
  }
  abandoned_.let_go();
  if (job_ || requested_.empty()) return;
  const IslandId island = map.graph().island(*requested_.begin());
  std::erase_if(requested_, [&](IslandId other) { return map.graph().island(other) == island; });
  if (map.graph().neighbours(island).empty()) return;
  job_ = std::make_unique<FitJob>(map, island, now_utime, std::nullopt, options);
}

}  // namespace isthmus
