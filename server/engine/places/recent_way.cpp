#include "server/engine/places/recent_way.hpp"

namespace isthmus {

void RecentWay::add(PatchId patch, double step_m, double max_m) {
  for (double& from_newest : from_newest_m) from_newest += step_m;
  newest_first.push_front(patch);
  from_newest_m.push_front(0);
  while (from_newest_m.back() > max_m) {
    newest_first.pop_back();
    from_newest_m.pop_back();
  }
}

}  // namespace isthmus
