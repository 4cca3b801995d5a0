#include "tools/simulate/wild/draw.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tools/simulate/plan/random.hpp"
#include "tools/simulate/wild/degree.hpp"
#include "tools/text/printed.hpp"

namespace isthmus {
namespace {

constexpr double longest_corridor_m = 200;
constexpr double longest_drive_m = 900;  // all laps
constexpr double max_scans = 8000;
constexpr double max_scans_of_team = 5000;  // of all its robots

double log_uniform(Random& random, double low, double high) {
  return std::exp(random.uniform(std::log(low), std::log(high)));
}

/// 0 with the chance that is left, else uniform.
double perhaps(Random& random, double chance, double low, double high) {
  const bool is_so = random.chance(chance);
  const double value = random.uniform(low, high);
  return is_so ? value : 0;
}

WildKind draw_kind(Random& random) {
  constexpr std::array kinds = {
      WildKind::offices,  WildKind::offices,  WildKind::offices,    WildKind::wings,      WildKind::halls,
      WildKind::corridor, WildKind::corridor, WildKind::courtyards, WildKind::courtyards, WildKind::repeated};
  return kinds[random.index(kinds.size())];
}

// Sides of a loop of corridors, or one corridor to drive there and back.
void draw_size(WildBuilding& building, double loop_m, Random& random) {
  const bool single =
      building.kind == WildKind::wings || (building.kind == WildKind::corridor && random.chance(0.4));
  const bool narrow = building.kind == WildKind::corridor;
  const double half_m = 0.5 * loop_m;
  building.wing_m = random.uniform(8, 25);
  building.corridors_along_y = 2;
  if (single) {
    building.width_m = 0;
    building.corridors_along_x = 1;
    building.length_m = std::clamp(narrow ? half_m : 0.5 * half_m, 15.0, longest_corridor_m);
    building.corridors_along_y = narrow ? 0 : std::clamp(static_cast<int>(building.length_m / 14), 1, 4);
    return;
  }
  const double share = narrow ? random.uniform(0.08, 0.2) : random.uniform(0.25, 0.5);
  building.width_m = std::max(8.0, share * half_m);
  building.length_m = std::max(building.width_m, half_m - building.width_m);
  if (narrow) building.length_m = std::min(building.length_m, longest_corridor_m);
  building.corridors_along_x = building.width_m > 28 && random.chance(0.6) ? 3 : 2;
  const int across = static_cast<int>(building.length_m / random.uniform(18, 45));
  building.corridors_along_y = narrow ? 2 : std::clamp(across + 1, 2, 5);
}

void draw_bend(WildBuilding& building, Random& random) {
  const double kind = random.uniform();
  building.bend = kind < 0.5 ? WildBend::straight : kind < 0.75 ? WildBend::crooked : WildBend::curved;
  building.bend_rad = building.bend == WildBend::straight ? 0 : random.uniform(0.15, 1.2);
}

void draw_inside(WildBuilding& building, Random& random) {
  building.corridor_m = random.uniform(1.9, 3.2);
  building.room_m = random.uniform(3.2, 7);
  building.room_depth_m = random.uniform(3.5, 7);
  building.hall_share =
      building.kind == WildKind::halls ? random.uniform(0.5, 1) : perhaps(random, 0.3, 0, 0.3);
  building.yard_share =
      building.kind == WildKind::courtyards ? random.uniform(0.5, 1) : perhaps(random, 0.3, 0, 0.3);
  building.glass_share = perhaps(random, 0.4, 0.02, 0.15);
  building.dark_share = perhaps(random, 0.4, 0.02, 0.2);
  building.roughness_m = random.uniform(0, 0.01);
  building.furniture =
      building.kind == WildKind::repeated ? random.uniform(0, 0.3) : random.uniform(0.2, 1.5);
  building.changes = random.chance(0.5) ? 1 + static_cast<int>(random.index(3)) : 0;
  building.moved_share = random.uniform(0.05, 0.4);
  building.closed_share = random.uniform(0.1, 0.7);
  building.fixture_m = log_uniform(random, 1.2, 5);
}

WildBuilding draw_building(double loop_m, Random random) {
  WildBuilding building;
  building.kind = draw_kind(random);
  draw_size(building, loop_m, random);
  draw_bend(building, random);
  draw_inside(building, random);
  return building;
}

// Houses of 18 m at least along streets that a laser may not see across.
WildBuilding draw_campus(double loop_m, Random random) {
  WildBuilding campus;
  campus.kind = WildKind::campus;
  draw_inside(campus, random);
  campus.corridor_m = random.uniform(8, 28);
  const double block_m = campus.corridor_m + 18, half_m = 0.5 * loop_m;
  campus.width_m = std::max(block_m, random.uniform(0.3, 0.5) * half_m);
  campus.length_m = std::max(campus.width_m, half_m - campus.width_m);
  campus.corridors_along_x = campus.width_m > 2 * block_m && random.chance(0.6) ? 3 : 2;
  const int across = static_cast<int>(campus.length_m / std::max(block_m, random.uniform(40, 90)));
  campus.corridors_along_y = std::clamp(across + 1, 2, 4);
  draw_bend(campus, random);
  campus.room_depth_m = 0;
  campus.hall_share = 0;
  campus.yard_share = 1;
  campus.fixture_m = log_uniform(random, 3, 15);
  campus.roughness_m = random.uniform(0, 0.03);
  campus.trees_per_m2 = random.uniform(0, 0.01);
  return campus;
}

// One that is made for streets.
void make_far_sighted(LaserPlan& laser, Random random) {
  constexpr std::array beams = {181, 361, 541, 720, 1081};
  laser.beams = beams[random.index(beams.size())];
  laser.laser.range_max_m = std::round(log_uniform(random, 25, 80));
  laser.bearing_sigma_rad = random.uniform(0, 0.001);
}

// A laser sees both walls of a corridor, and the far wall of all but the largest halls.
LaserPlan draw_laser(const WildBuilding& building, Random random) {
  LaserPlan laser;
  constexpr std::array beams = {90, 121, 180, 181, 270, 361, 541, 720, 1081};
  laser.beams = beams[random.index(beams.size())];
  constexpr std::array views_deg = {180, 180, 190, 240, 270, 360};
  laser.field_of_view_rad = views_deg[random.index(views_deg.size())] * degree;
  if (laser.field_of_view_rad > 350 * degree) laser.field_of_view_rad *= 1 - 1.0 / laser.beams;
  laser.rate_hz = random.uniform(3, 5);
  laser.laser.range_min_m = random.uniform(0.02, 0.1);
  laser.laser.range_max_m =
      0.5 * std::round(2 * std::max(log_uniform(random, 4, 30), 2 * building.corridor_m));
  laser.laser.robot_from_laser = {random.uniform(-0.1, 0.2), random.uniform(-0.03, 0.03), 0};
  laser.declared_mount_error = {random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02),
                                random.uniform(-1, 1) * degree};
  laser.range_sigma_m = log_uniform(random, 0.002, 0.03);
  laser.bearing_sigma_rad = random.uniform(0, 0.003);
  laser.dropout_share = random.uniform(0, 0.02);
  laser.no_return_share = perhaps(random, 0.3, 0.01, 0.12);
  laser.return_limit_rad = random.uniform(75, 90) * degree;
  laser.no_return_is_infinite = random.chance(0.5);
  laser.interlaced = random.chance(0.1);
  laser.scan_lag_s = random.uniform(-0.3, 1) / laser.rate_hz * (random.chance(0.6) ? 1 : 0);
  return laser;
}

OdometryPlan draw_odometry(Random random) {
  OdometryPlan odometry;
  odometry.rate_hz = random.uniform(8, 20);
  odometry.linear_share = random.uniform(0.01, 0.1);
  odometry.angular_share = random.uniform(0.02, 0.15);
  odometry.noise_period_s = log_uniform(random, 0.2, 2);
  odometry.linear_scale = 1 + random.normal(0.02);
  odometry.angular_scale = 1 + random.normal(0.03);
  odometry.curvature_rpm = random.normal(0.008);
  return odometry;
}

WheelFaults draw_faults(Random random) {
  WheelFaults faults;
  if (random.chance(0.35)) {
    faults.slip_chance = random.uniform(0.1, 0.6);
    faults.slip_share = random.uniform(0.1, 0.5);
  }
  faults.told_rps = perhaps(random, 0.3, 0.5, 1.2);
  if (random.chance(0.3)) {
    faults.freeze_chance = random.uniform(0.05, 0.5);
    faults.freeze_s = random.uniform(0.3, 2);
    faults.freezes_per_min = perhaps(random, 0.5, 0.05, 0.5);
  }
  if (random.chance(0.15)) {
    faults.jumps_per_min = random.uniform(0.05, 0.5);
    faults.jump_rad = random.uniform(2, 40) * degree;
  }
  faults.lag_s = perhaps(random, 0.3, 0.02, 0.15);
  faults.jitter_s = perhaps(random, 0.35, 0.002, 0.01);
  return faults;
}

DrivePlan draw_drive(Random random) {
  DrivePlan drive;
  drive.turn_rate_rps = random.uniform(0.5, 1.9);
  drive.speed_mps = random.uniform(0.45, std::min(0.9, 0.4 + 0.4 * drive.turn_rate_rps));
  drive.acceleration_mps2 = 1.5 * drive.speed_mps;
  drive.lookahead_m = random.uniform(0.35, 0.5);
  drive.waypoint_jitter_m = random.uniform(0.02, 0.1);
  return drive;
}

int draw_team(Random& random) {
  constexpr std::array sizes = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 4, 5, 6};
  return sizes[random.index(sizes.size())];
}

void draw_robots(WildDraw& draw, Random random) {
  const std::uint64_t seed = draw.seed;
  const int count = draw_team(random);
  const bool alike = random.chance(0.7);
  for (int i = 0; i < count; ++i) {
    const std::string number = std::to_string(i);
    WildRobot robot;
    robot.laser = draw_laser(draw.building, Random(seed, "wild laser" + (alike ? "" : number)));
    if (draw.building.kind == WildKind::campus)
      make_far_sighted(robot.laser, Random(seed, "wild far laser" + (alike ? "" : number)));
    robot.odometry = draw_odometry(Random(seed, "wild odometry" + number));
    robot.faults = draw_faults(Random(seed, "wild faults" + (alike ? "" : number)));
    robot.drive = draw_drive(Random(seed, "wild drive" + (alike ? "" : number)));
    robot.backwards = random.chance(0.5);
    robot.own_loop = random.chance(0.4) && i > 0;
    robot.start_s = i == 0 ? 0 : random.uniform(0, 20);
    draw.robots.push_back(robot);
  }
}

void draw_camera(WildDraw& draw, Random random) {
  draw.camera.rate_hz = random.chance(0.75) ? random.uniform(1, 3) : 0;
  draw.camera.range_max_m = random.uniform(3, 8);
  draw.camera.field_of_view_rad =
      random.chance(0.5) ? 2 * std::numbers::pi : random.uniform(60, 180) * degree;
  draw.camera.range_sigma_m = random.uniform(0.02, 0.08);
  draw.camera.bearing_sigma_rad = random.uniform(0.01, 0.07);
  const double share = perhaps(random, 0.5, 0.02, 0.3);
  if (draw.robots.size() > 1 && draw.camera.rate_hz > 0) draw.false_sightings = share;
  if (draw.robots.size() == 1) draw.camera.rate_hz = 0;
}

WildTour draw_tour(Random random) {
  WildTour tour;
  tour.loop_m = random.chance(0.7) ? log_uniform(random, 50, 250) : log_uniform(random, 250, 1000);
  const auto most = static_cast<std::size_t>(std::clamp(longest_drive_m / tour.loop_m, 1.0, 3.0));
  tour.laps = 1 + static_cast<int>(random.index(most));
  tour.overlap_m = random.uniform(15, 40);
  tour.rooms_per_100m = random.uniform(0, 5) * std::min(1.0, 200 / tour.loop_m);
  tour.spins_per_100m = perhaps(random, 0.6, 0.3, 4) * std::min(1.0, 200 / tour.loop_m);
  return tour;
}

// Round blocks of a campus, and seldom on the spot.
void stretch(WildTour& tour, Random random) {
  tour.loop_m = log_uniform(random, 250, longest_drive_m);
  tour.laps = tour.loop_m < 0.5 * longest_drive_m && random.chance(0.5) ? 2 : 1;
  tour.overlap_m = random.uniform(30, 80);
  tour.rooms_per_100m = 0;
  tour.spins_per_100m *= 0.2;
}

// Long tours are driven fewer times, by smaller teams, and scanned more slowly.
void bound_cost(WildDraw& draw) {
  const auto excess = [&] {
    double scans = 0;
    for (const WildRobot& robot : draw.robots)
      scans += 1.3 * draw.tour.loop_m * draw.tour.laps / robot.drive.speed_mps * robot.laser.rate_hz;
    return scans / (draw.robots.size() > 1 ? max_scans_of_team : max_scans);
  };
  while (excess() > 1 && draw.tour.laps > 1) --draw.tour.laps;
  while (excess() > 1 && draw.robots.size() > 1) draw.robots.pop_back();
  const double share = std::min(1.0, 1 / excess());
  for (WildRobot& robot : draw.robots) robot.laser.rate_hz = std::max(3.0, share * robot.laser.rate_hz);
  if (draw.robots.size() == 1) draw.camera.rate_hz = draw.false_sightings = 0;
}

}  // namespace

WildDraw draw_wild(std::uint64_t seed, WildPlace place) {
  const bool is_campus = place == WildPlace::campus;
  WildDraw draw;
  draw.seed = seed;
  draw.tour = draw_tour(Random(seed, "wild tour"));
  if (is_campus) stretch(draw.tour, Random(seed, "wild campus tour"));
  draw.building = is_campus ? draw_campus(draw.tour.loop_m, Random(seed, "wild campus"))
                            : draw_building(draw.tour.loop_m, Random(seed, "wild building"));
  draw_robots(draw, Random(seed, "wild robots"));
  draw_camera(draw, Random(seed, "wild camera"));
  Random people(seed, "wild people");
  if (people.chance(0.5)) draw.people = 1 + static_cast<int>(people.index(4));
  bound_cost(draw);
  return draw;
}

std::vector<WildTrait> traits_of(const WildDraw& draw) {
  const WildBuilding& building = draw.building;
  const WildRobot& robot = draw.robots.front();
  std::vector<WildTrait> traits;
  for (std::size_t i = 0; i < words_of<WildKind>.size(); ++i)
    traits.push_back({std::string(words_of<WildKind>[i]), building.kind == static_cast<WildKind>(i)});
  traits.insert(traits.end(), {{"bent", building.bend != WildBend::straight},
                               {"glass", building.glass_share > 0},
                               {"dark walls", building.dark_share > 0},
                               {"changes", building.changes > 0},
                               {"people", draw.people > 0},
                               {"loop > 200 m", draw.tour.loop_m > 200},
                               {"loop > 500 m", draw.tour.loop_m > 500},
                               {"laps > 1", draw.tour.laps > 1},
                               {"spins", draw.tour.spins_per_100m > 0},
                               {"range < 8 m", robot.laser.laser.range_max_m < 8},
                               {"beams < 181", robot.laser.beams < 181},
                               {"view > 200 deg", robot.laser.field_of_view_rad > 200 * degree},
                               {"no returns", robot.laser.no_return_share > 0},
                               {"turns > 1 rad/s", robot.drive.turn_rate_rps > 1},
                               {"slip", robot.faults.slip_chance > 0},
                               {"told late", robot.faults.told_rps > 0 &&
                                                 robot.faults.told_rps < robot.drive.turn_rate_rps},
                               {"freezes", robot.faults.freeze_s > 0},
                               {"jumps", robot.faults.jumps_per_min > 0},
                               {"lag", robot.faults.lag_s > 0 || robot.laser.scan_lag_s > 0},
                               {"jitter", robot.faults.jitter_s > 0},
                               {"team", draw.robots.size() > 1},
                               {"no sightings", draw.robots.size() > 1 && draw.camera.rate_hz <= 0},
                               {"false sightings", draw.false_sightings > 0}});
  return traits;
}

std::string describe(const WildDraw& draw) {
  const WildBuilding& b = draw.building;
  const WildRobot& r = draw.robots.front();
  std::string line =
      printed("%s %s %.0fx%.0f m, loop %.0f m x%d, %zu rob %d people, %d beams %.0f deg %.0f m",
              std::string(word(b.kind)).c_str(), std::string(word(b.bend)).c_str(), b.length_m, b.width_m,
              draw.tour.loop_m, draw.tour.laps, draw.robots.size(), draw.people, r.laser.beams,
              r.laser.field_of_view_rad / degree, r.laser.laser.range_max_m);
  line += printed(", %.1f m/s %.1f rad/s", r.drive.speed_mps, r.drive.turn_rate_rps);
  for (const WildTrait& trait : traits_of(draw)) {
    static const std::vector<std::string> told = {
        "glass",   "dark walls", "changes", "spins",  "no returns",   "slip",           "told late",
        "freezes", "jumps",      "lag",     "jitter", "no sightings", "false sightings"};
    if (trait.holds && std::ranges::count(told, trait.name) > 0) line += ", " + trait.name;
  }
  return line;
}

}  // namespace isthmus
