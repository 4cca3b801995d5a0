#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/engine/frozen/lost_robot.hpp"
#include "server/engine/input/configuration.hpp"
#include "server/engine/input/event.hpp"
#include "server/engine/outcome.hpp"
#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// What makes a map of events: the manifold engine, or maps of features. All that a server needs of either to
/// run it: the same events give the same map.
class Estimator {
 public:
  virtual ~Estimator() = default;

  virtual Outcome handle(const Event& event) = 0;

  /// Whether it is odometry, a scan or a sighting of a robot that has not introduced itself.
  virtual bool is_stranger(const Event& event) const = 0;

  /// Counts messages that never became events. `robot` may be empty.
  virtual void count_dropped(const std::string& robot, DropReason reason, std::int64_t messages) = 0;

  /// What remains to be done when no more events will come, in bounded pieces: false once all is done.
  virtual bool finish_step(Outcome& outcome) = 0;
  virtual std::string_view finishing() const = 0;

  /// Whether work waits that a TickEvent would advance.
  virtual bool has_queued_work() const = 0;

  virtual const Configuration& configuration() const = 0;

  /// Where robots are looked for, and are not found.
  virtual std::vector<LostRobot> lost_robots() const { return {}; }

  /// What there is to tell of robots, sightings, closures and counts, and of the map what is patches.
  virtual MapCopy copy() const = 0;
};

}  // namespace isthmus
