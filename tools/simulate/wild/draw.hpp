#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "server/engine/input/words.hpp"
#include "tools/simulate/scenario/scenario.hpp"
#include "tools/simulate/wild/wheel_faults.hpp"

namespace isthmus {

/// What is drawn at all.
enum class WildPlace : std::uint8_t { building, campus };

enum class WildKind : std::uint8_t {
  offices,     ///< a ring of corridors and some through it, rooms of all sizes
  wings,       ///< one corridor, and wings that end blind
  halls,       ///< large rooms along a ring
  corridor,    ///< one long corridor, or two that are joined at their ends
  courtyards,  ///< corridors round yards
  repeated,    ///< as offices, each room like the next
  campus       ///< wide streets with trees between houses, a fence all around; corridors are its streets
};
template <>
inline constexpr auto words_of<WildKind> = std::to_array<std::string_view>({"offices", "wings", "halls",
                                                                            "corridor", "courtyards",
                                                                            "repeated", "campus"});

/// How the building is bent along its length.
enum class WildBend : std::uint8_t {
  straight,
  crooked,  ///< pieces that lie askew to one another
  curved    ///< one arc
};
template <>
inline constexpr auto words_of<WildBend> = std::to_array<std::string_view>({"straight", "crooked", "curved"});

struct WildBuilding {
  WildKind kind = WildKind::offices;
  WildBend bend = WildBend::straight;
  double bend_rad = 0;   ///< of each bend, at most
  double length_m = 40;  ///< between the middle lines of the outermost corridors, along x
  double width_m = 20;   ///< along y; 0: there is one corridor along x
  int corridors_along_x = 2;
  int corridors_along_y = 2;
  double corridor_m = 2.2;  ///< width
  double room_m = 4.5;      ///< along the corridor
  double room_depth_m = 5;
  double hall_share = 0;  ///< of the blocks between corridors
  double yard_share = 0;
  double wing_m = 15;
  double trees_per_m2 = 0;  ///< of streets
  double glass_share = 0;   ///< of walls; nothing comes back unless the beam is square to them
  double dark_share = 0;    ///< of walls that give no return at a slant
  double roughness_m = 0.004;
  double fixture_m = 2;     ///< between frames and pillars along a corridor's walls
  double furniture = 1;     ///< times the usual number of pieces
  int changes = 0;          ///< times at which doors and furniture are found otherwise
  double moved_share = 0;   ///< of the furniture, each time
  double closed_share = 0;  ///< of the doors that nobody drives through, each time
};

struct WildTour {
  double loop_m = 100;  ///< about one lap
  int laps = 1;
  double overlap_m = 20;  ///< driven on after the last lap, where the robot has been before
  double rooms_per_100m = 3;
  double spins_per_100m = 1;  ///< turns on the spot, half a turn or more
};

struct WildRobot {
  LaserPlan laser;
  OdometryPlan odometry;
  WheelFaults faults;
  DrivePlan drive;
  bool backwards = false;  ///< round the loop
  bool own_loop = false;   ///< another loop of the building than the first robot's
  double start_s = 0;
};

/// All that a seed decides of a run, but for the noise.
struct WildDraw {
  std::uint64_t seed = 0;
  WildBuilding building;
  WildTour tour;
  std::vector<WildRobot> robots;
  int people = 0;
  CameraPlan camera;  ///< every robot's
  double false_sightings = 0;
};

/// The same for the same seed and place, always.
WildDraw draw_wild(std::uint64_t seed, WildPlace place = WildPlace::building);

/// A property of a draw, yes or no, by which failed runs can be told from the others.
struct WildTrait {
  std::string name;
  bool holds = false;
};
std::vector<WildTrait> traits_of(const WildDraw& draw);

/// What was drawn, in one line.
std::string describe(const WildDraw& draw);

}  // namespace isthmus
