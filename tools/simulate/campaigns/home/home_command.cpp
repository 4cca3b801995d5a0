#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include "server/output/format/atomic_file.hpp"
#include "server/output/pictures/map_sheet.hpp"
#include "server/output/pictures/marks.hpp"
#include "server/output/pictures/way_pen.hpp"
#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/values.hpp"
#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/live/home_run.hpp"
#include "tools/simulate/truth/plan_picture.hpp"

namespace isthmus {
namespace {

struct HomeArguments : CampaignRuns {
  HomeRunOptions run;
  std::string pictures;
};

void print(const std::string& what, const HomeScore& s) {
  std::printf("%-18s %-4s %-5s %7.1f %7.1f %8.1f %7.0f %6.2f %7zu %6zu %7zu  %s\n", what.c_str(),
              s.robot.c_str(), s.home ? "home" : "LOST", s.out_m, s.way_m, s.driven_m, s.time_s, s.end_m,
              s.islands_out, s.touched_walls, s.touched_robots, s.refusal.c_str());
  std::fflush(stdout);
}

/// The true ways: out thin and grey, home in the robots' colours.
void draw(const FloorPlan& plan, const HomeView& view, const std::string& what, const std::string& path) {
  Legend legend;
  for (const std::string& name : view.names) legend.push_back(way_entry(name, way_style(legend.size())));
  legend.push_back(start_entry());
  legend.push_back(end_entry());
  MapSheet sheet(plain_grid(plan, OccupancyGrid::free), {what, "true ways: out grey, home coloured"}, legend);
  draw_walls(sheet, plan);
  for (const auto& way : view.out)
    for (std::size_t i = 1; i < way.size(); ++i)
      sheet.canvas().line(std::array{sheet.window().pixels(way[i - 1]), sheet.window().pixels(way[i])},
                          {.colour = ink::faint, .width_px = way_line_px(sheet.window().em)});
  for (std::size_t robot = 0; robot < view.home.size(); ++robot) {
    WayPen pen(sheet.canvas(), sheet.window(), way_style(robot));
    for (const Eigen::Vector2d& point : view.home[robot]) pen.to(point);
  }
  for (std::size_t robot = 0; robot < view.home.size(); ++robot) {
    draw_start(sheet.canvas(), sheet.window(), view.starts[robot], way_style(robot));
    draw_end(sheet.canvas(), sheet.window(), view.ends[robot], way_style(robot));
  }
  sheet.write(path);
}

void home_campaign(const HomeArguments& arguments) {
  check_new_files_in(arguments.pictures, {".png"}, arguments.force);
  if (!arguments.pictures.empty()) make_directory(arguments.pictures);
  std::printf("%-18s %-4s %-5s %7s %7s %8s %7s %6s %7s %6s %7s\n", "", "", "", "out m", "way m", "driven m",
              "time s", "end m", "islands", "walls", "robots");
  std::size_t runs = 0, home = 0;
  for (const std::string& name : arguments.scenarios) {
    for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
      const Scenario scenario = arguments.load(name, seed);
      const std::string what = name + "-" + std::to_string(seed);
      const auto watch = [&](const HomeView& view) {
        draw(scenario.plan, view, what, arguments.pictures + "/" + what + ".png");
      };
      for (const HomeScore& score :
           come_home(scenario, seed, arguments.run, arguments.pictures.empty() ? WatchHome{} : watch)) {
        ++runs;
        home += score.home;
        print(what, score);
      }
    }
  }
  std::printf("%zu of %zu came home\n", home, runs);
}

}  // namespace

void add_home_command(CLI::App& app) {
  const auto arguments = std::make_shared<HomeArguments>();
  arguments->seeds = 10;
  CLI::App* home = app.add_subcommand(
      "home",
      "Lets robots explore simulated buildings for a while, each from its own start, and then drive home by\n"
      "their own ways back, while the map merges; tells which of them came home.");
  arguments->add_scenarios(*home);
  arguments->add_runs(*home);
  home->add_option("--robots", arguments->run.robots, "the scenario's first")
      ->check(integer_from(1))
      ->capture_default_str();
  home->add_option("--out-time", arguments->run.out_s, "that they explore for, s")
      ->check(number_above(0))
      ->capture_default_str();
  home->add_option("--pictures", arguments->pictures, "directory for a picture of each run");
  add_force(*home, arguments->force);
  home->callback([arguments] { home_campaign(*arguments); });
}

}  // namespace isthmus
