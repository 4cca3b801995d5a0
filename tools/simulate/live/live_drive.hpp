#pragma once

#include <cstdint>
#include <string>

#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

struct LiveDriveOptions {
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  double speed = 1;           ///< seconds of the run in a second
  double max_s = 600;         ///< of the run; it is given up then
  std::size_t robots = 0;     ///< the first of the scenario's; 0: all
  bool side_by_side = false;  ///< they start beside the first one, not where the scenario has them
  double clearance_m = 0.1;   ///< from walls: what is ground that robots can come to
  double radio_range_m = 0;   ///< from where the first one starts: beyond it a robot hears nothing, and what
                              ///< it sends comes when it is back; 0: everywhere
  std::string pictures;       ///< directory; empty: none
  double picture_s = 60;      ///< of the run, between pictures
};

/// What became of robots that drove by a server's goals.
struct LiveDriveScore {
  double reachable_m2 = 0;  ///< where a robot's centre can come to
  double share = 0;         ///< of it that their lasers saw
  double end_s = 0;         ///< of the run
  double wall_s = 0;        ///< of the clock
  double way_m = 0;         ///< of the whole team
  bool finished = false;    ///< the server said that nothing is left
  std::size_t goals = 0;    ///< that robots were given
  std::size_t touched_walls = 0;
  std::size_t touched_robots = 0;
  std::size_t out_of_reach = 0;  ///< times that a robot left the radio's range
  std::size_t late_ticks = 0;    ///< at which this machine did not keep up
};

/// Robots in the scenario's building, in real time: they send what they sense over LCM, and drive by what a
/// server with [exploration] tells them on <ROBOT>_GOAL, round what their own lasers see; one that hears
/// nothing goes on with its last goal, and out of reach of the radio, at its end, comes back on the way that
/// it went. Throws std::runtime_error where the network cannot be opened or there is no room for the robots
/// to start.
LiveDriveScore drive_live(const Scenario& scenario, std::uint64_t seed, const LiveDriveOptions& options);

}  // namespace isthmus
