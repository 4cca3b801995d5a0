#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

struct HomeRunOptions {
  std::size_t robots = 3;    ///< the first of the scenario's, where it has them start
  double out_s = 120;        ///< they explore for so long,
  double clearance_m = 0.1;  ///< keeping so far from walls
  double home_m = 0.5;       ///< a robot so near to where it started, in truth, is home
  double stopped_s = 60;     ///< one that is not, and did not get on for so long, is lost
};

/// What became of one robot on its way home.
struct HomeScore {
  std::string robot;
  bool home = false;
  double out_m = 0;               ///< driven on the way out
  double way_m = 0;               ///< of the way back when it was first asked for
  double driven_m = 0;            ///< on the way home
  double time_s = 0;              ///< of it
  double end_m = 0;               ///< from where it started, in the end
  std::string refusal;            ///< of the last question that had no answer, if any
  std::size_t islands_out = 0;    ///< that the team was on when it turned back
  std::size_t touched_walls = 0;  ///< by the team, on the way home
  std::size_t touched_robots = 0;
};

/// The true ways, for those who draw them: out, and home.
struct HomeView {
  std::vector<std::string> names;
  std::vector<Pose> starts, ends;
  std::vector<std::vector<Eigen::Vector2d>> out, home;
};
using WatchHome = std::function<void(const HomeView&)>;

/// Robots explore a simulated building for a while, each from its own start, while their maps merge; then
/// each retro-traverses: it is told its own way back (`DrivenWays::back`), anew each second, and drives it by
/// its pilot; robots give way to one another. The same for the same arguments.
std::vector<HomeScore> come_home(const Scenario& scenario, std::uint64_t seed, const HomeRunOptions& options,
                                 const WatchHome& watch = {});

}  // namespace isthmus
