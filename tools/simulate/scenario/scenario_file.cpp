#include "tools/simulate/scenario/scenario_file.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include "server/program/command_line.hpp"
#include "server/program/spelling.hpp"
#include "tools/simulate/scenario/building_file.hpp"
#include "tools/simulate/scenario/floor_file.hpp"
#include "tools/simulate/scenario/robot_file.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;

// A straight way of a robot's tour, and the steps of the tour at its ends.
struct Leg {
  Segment way;
  std::optional<std::size_t> from_step;  // none: where the robot starts or was put down
  std::size_t to_step = 0;
};

// The legs of a lap and, where there is more than one lap, those from its end to its beginning again.
std::vector<Leg> legs_of(const RobotPlan& robot) {
  std::vector<Leg> legs;
  Vector2d at(robot.start.x, robot.start.y);
  std::optional<std::size_t> from;
  for (int lap = 0; lap < std::min(robot.laps, 2); ++lap) {
    for (std::size_t i = 0; i < robot.tour.size(); ++i) {
      if (const auto* waypoint = std::get_if<Waypoint>(&robot.tour[i])) {
        legs.push_back({Segment{at, waypoint->position}, from, i});
        at = waypoint->position;
        from = i;
      } else if (const auto* carry = std::get_if<Carry>(&robot.tour[i])) {
        at = {carry->world_from_robot.x, carry->world_from_robot.y};
        from.reset();
      }
    }
  }
  return legs;
}

// Notes how near each leg comes to a wall, and refuses a tour that the robot cannot drive.
void check_tour(RobotFromFile& robot, const FloorPlan& plan) {
  for (const Leg& leg : legs_of(robot.plan)) {
    const double clearance = clearance_m(plan, leg.way.a, leg.way.b);
    if (clearance < robot.plan.radius_m + 0.05) {
      std::ostringstream reason;
      reason << robot.plan.name << "'s way from (" << leg.way.a.transpose() << ") to ("
             << leg.way.b.transpose() << ") comes within " << clearance << " m of a wall";
      fail_at(robot.step_where[leg.to_step], reason.str());
    }
    for (const std::size_t step : {leg.to_step, leg.from_step.value_or(leg.to_step)}) {
      auto& waypoint = std::get<Waypoint>(robot.plan.tour[step]);
      waypoint.clearance_m = std::min(waypoint.clearance_m, clearance);
    }
  }
}

std::vector<TagPlan> read_tags(const Setting* setting) {
  std::vector<TagPlan> tags;
  if (setting == nullptr) return tags;
  for (const Setting& tag : as_list(*setting, "a list of [barcode, x, y]")) {
    const auto n = as_numbers(tag, 3, "[barcode, x, y]");
    tags.push_back({static_cast<int>(n[0]), {n[1], n[2]}});
  }
  return tags;
}

std::vector<RobotFromFile> read_robots(const Setting& table, const RobotPlan& common) {
  const auto* robots = std::get_if<Setting::Table>(&table.value);
  if (robots == nullptr || robots->empty()) fail_at(table.where, "'robots' must be a table of robots");
  std::vector<RobotFromFile> read;
  for (const auto& [name, robot] : *robots) read.push_back(read_robot(name, robot, common));
  return read;
}

// A building, where its clutter may lie, and who drives in it.
struct Site {
  Building building;
  Clutter clutter;
  std::vector<RobotFromFile> robots;
};

// The building stands in the scenario, or in a file named relative to the scenario's, or is made.
Site read_site(Fields& fields, const fs::path& file) {
  const RobotPlan common = read_common(fields);
  Site site;
  if (const Setting* floor = fields.find("floor")) {
    if (fields.has("building")) fail_at(floor->where, "a scenario has a floor or a building, not both");
    auto made = make_floor(*floor, fields.find("robots"), common);
    site.building = std::move(made.building);
    site.robots = std::move(made.robots);
    return site;
  }
  site.robots = read_robots(fields.require("robots"), common);
  const Setting& setting = fields.require("building");
  const auto* name = std::get_if<std::string>(&setting.value);
  std::tie(site.building, site.clutter) =
      read_building(name == nullptr ? setting : read_toml((file.parent_path() / *name).string()));
  fields.read_within("roughness_m", site.building.roughness_m, 0, 0.1);  // instead of the building's own
  return site;
}

Scenario read_scenario(const Setting& root, const fs::path& file) {
  Fields fields(root);
  Scenario scenario;
  scenario.name = file.stem().string();
  fields.read("summary", scenario.summary);
  fields.read_within("start_utime", scenario.start_utime, 0, std::numeric_limits<std::int64_t>::max());
  fields.read_within("duration_s", scenario.duration_s, 0, 1e9);
  fields.read("bodies_visible", scenario.bodies_visible);
  fields.read("robots_give_way", scenario.robots_give_way);
  fields.read_within("false_sightings", scenario.false_sightings, 0, 0.95);
  scenario.tags = read_tags(fields.find("tags"));
  auto [building, clutter, robots] = read_site(fields, file);
  fields.finish();

  std::vector<Segment> ways;
  for (const RobotFromFile& robot : robots) {
    for (const Leg& leg : legs_of(robot.plan)) ways.push_back(leg.way);
  }
  for (auto& polygon : strew(clutter, building, ways)) building.furniture.push_back(std::move(polygon));
  scenario.plan = build_floor_plan(building);
  for (RobotFromFile& robot : robots) {
    check_tour(robot, scenario.plan);
    scenario.robots.push_back(std::move(robot.plan));
  }
  return scenario;
}

// Beside the installed program, else in the sources that it was built from.
fs::path scenario_directory() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  fs::path installed = program.parent_path().parent_path() / "share" / "isthmus" / "scenarios";
  if (!error && fs::is_directory(installed)) return installed;
  return ISTHMUS_SCENARIO_DIRECTORY;
}

std::vector<std::string> scenario_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(scenario_directory()))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  std::ranges::sort(names);
  return names;
}

}  // namespace

Scenario load_scenario(const std::string& name_or_file, const std::vector<std::string>& overrides) {
  fs::path file = name_or_file;
  if (name_or_file.find('/') == std::string::npos && file.extension() != ".toml") {
    file = scenario_directory() / (name_or_file + ".toml");
    if (!fs::exists(file)) {
      throw UsageError("no scenario is called '" + name_or_file + "'; isthmus-simulate --list names them" +
                       did_you_mean(name_or_file, scenario_names()));
    }
  }
  Setting root = read_toml(file.string());
  try {
    for (const std::string& assignment : overrides) override_setting(root, assignment);
    return read_scenario(root, file);
  } catch (const SettingError& error) {
    if (std::string_view(error.what()).starts_with(override_mark)) throw UsageError(error.what());
    throw;
  }
}

std::vector<ScenarioSummary> list_scenarios() {
  std::vector<ScenarioSummary> scenarios;
  for (const std::string& name : scenario_names()) {
    ScenarioSummary one{name, ""};
    const Setting root = read_toml((scenario_directory() / (name + ".toml")).string());
    if (const Setting* summary = Fields(root).find("summary")) {
      if (const auto* text = std::get_if<std::string>(&summary->value)) one.summary = *text;
    }
    scenarios.push_back(std::move(one));
  }
  return scenarios;
}

}  // namespace isthmus
