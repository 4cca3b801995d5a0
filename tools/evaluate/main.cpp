#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <map>
#include <stdexcept>

#include "server/engine/input/robot_name.hpp"
#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/spelling.hpp"
#include "server/program/values.hpp"
#include "tools/evaluate/error_pictures.hpp"
#include "tools/evaluate/failure.hpp"

namespace {

using namespace isthmus;

struct Arguments {
  std::string relations;
  std::string truth;
  std::string output;
  std::string robot;
  std::string g2o;
  std::string pictures;
  LandmarkArguments landmarks;
  bool json = false;
  bool force = false;
};

bool ends_with(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// The robot that was asked for, which must be one of the map's.
std::string known_robot(const Arguments& arguments, const TeamTrajectories& team) {
  std::string robot = upper_case(arguments.robot);
  if (team.trajectories().contains(robot)) return robot;
  std::vector<std::string> names;
  for (const auto& [name, trajectory] : team.trajectories()) names.push_back(name);
  throw std::runtime_error(arguments.output + ": no robot " + robot + " is on this map" +
                           did_you_mean(robot, names));
}

/// A `.relations` file does not say whose it is: the only robot's, or the one asked for.
std::string robot_of_benchmark(const Arguments& arguments, const TeamTrajectories& team) {
  if (!arguments.robot.empty()) return known_robot(arguments, team);
  if (team.trajectories().size() == 1) return team.trajectories().begin()->first;
  throw std::runtime_error(arguments.output + ": several robots: say with --robot whose relations these are");
}

std::vector<TrueRelation> read_relations(const Arguments& arguments, const TeamTrajectories& team) {
  if (ends_with(arguments.relations, ".csv")) return read_team_relations(arguments.relations);
  return read_benchmark_relations(arguments.relations, robot_of_benchmark(arguments, team));
}

/// Fixed tags are compared where the truth has any.
TagsToCompare read_tags(const Arguments& arguments) {
  TagsToCompare tags;
  const std::string truth = arguments.truth + "/tags.csv";
  const std::string placed = arguments.output + "/tags.csv";
  if (!std::filesystem::exists(truth)) return tags;
  tags.truth = read_true_tags(truth);
  if (std::filesystem::exists(placed)) tags.map = read_placed_tags(placed);
  return tags;
}

std::vector<TrueWall> read_walls(const std::string& truth) {
  const std::string file = truth + "/floor_plan.csv";
  return std::filesystem::exists(file) ? read_floor_plan(file) : std::vector<TrueWall>{};
}

/// Those of an earlier evaluation stay, unless --force is given.
void check_no_pictures(const Arguments& arguments) {
  check_new_files_in(arguments.pictures, {"-errors.png"}, arguments.force);
}

/// Of poses where there is their truth, else of relations.
void draw(const Arguments& arguments, const Evaluation& evaluation) {
  const TeamTrajectories team(arguments.output);
  ErrorPictures pictures;
  pictures.output = arguments.output;
  pictures.robots = team.robots();
  if (evaluation.absolute) {
    pictures.name = "errors";
    pictures.what = "positions";
    pictures.errors = errors_of_poses(*evaluation.absolute);
    pictures.walls = read_walls(arguments.truth);
    for (const IslandErrors& island : evaluation.absolute->islands)
      pictures.truth_from_map[island.island] = island.truth_from_map;
    write_error_pictures(pictures, arguments.pictures);
  }
  if (arguments.relations.empty()) return;
  pictures.name = "relation-errors";
  pictures.what = "relations";
  pictures.joined = false;
  pictures.errors = errors_of_relations(read_relations(arguments, team), team);
  write_error_pictures(pictures, arguments.pictures);
}

Evaluation evaluate(const Arguments& arguments) {
  Evaluation evaluation;
  if (!arguments.g2o.empty()) evaluation.pose_graph = fit_pose_graph(arguments.g2o);
  if (!arguments.landmarks.file.empty()) evaluation.landmarks = evaluate_landmarks(arguments.landmarks);
  if (arguments.relations.empty() && arguments.truth.empty()) return evaluation;
  const TeamTrajectories team(arguments.output);
  if (!arguments.robot.empty()) known_robot(arguments, team);
  if (!arguments.relations.empty()) {
    evaluation.relations = evaluate_relations(read_relations(arguments, team), team);
  }
  if (!arguments.truth.empty()) {
    const std::string relations = arguments.truth + "/relations.csv";
    if (arguments.relations.empty() && std::filesystem::exists(relations)) {
      evaluation.relations = evaluate_relations(read_team_relations(relations), team);
    }
    evaluation.absolute = evaluate_absolute(read_trajectories(arguments.truth), team, read_tags(arguments));
  }
  return evaluation;
}

CLI::Option* add_landmarks(CLI::App& app, LandmarkArguments& arguments) {
  auto* file = app.add_option(
      "--landmarks", arguments.file,
      "a log of odometry and landmarks of iSAM's form, plain or gz: the feature filter in both "
      "forms and one batch fit");
  auto* truth =
      app.add_option("--landmarks-truth", arguments.truth, "the same log without noise")->needs(file);
  app.add_option("--association", arguments.association, "which landmark is which: known, joint or nearest")
      ->transform(
          one_of(std::map<std::string, LandmarkAssociation>{{"known", LandmarkAssociation::known},
                                                            {"joint", LandmarkAssociation::joint},
                                                            {"nearest", LandmarkAssociation::nearest}}))
      ->needs(file);
  app.add_option("--noises", arguments.noises, "runs with fresh noise on --landmarks-truth besides")
      ->type_name("COUNT")
      ->check(integer_from(0))
      ->needs(truth);
  return file;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Compares a map with ground truth, fits a pose graph, or maps a log of landmarks.",
               "isthmus-evaluate");
  Arguments arguments;
  auto* relations =
      app.add_option("--relations", arguments.relations,
                     "true relations: *.relations of the SLAM benchmark, or relations.csv of a team");
  auto* truth =
      app.add_option("--truth", arguments.truth, "a directory with ROBOT.tum, relations.csv and tags.csv");
  auto* output =
      app.add_option("-o,--output", arguments.output, "what isthmus-replay or isthmus-server wrote");
  app.add_option("--robot", arguments.robot, "the robot that the relations are of, if the map has several");
  auto* g2o = app.add_option("--g2o", arguments.g2o, "a pose graph to fit in one batch, plain or gz");
  auto* landmarks = add_landmarks(app, arguments.landmarks);
  auto* pictures =
      app.add_option("--pictures", arguments.pictures,
                     "directory for pictures of each island: where the map is off and by how much, over "
                     "the true floor plan where the truth has one, and errors over time")
          ->type_name("DIR")
          ->needs(output);
  app.add_flag("--json", arguments.json, "print JSON");
  add_force(app, arguments.force);
  relations->needs(output);
  truth->needs(output);
  return run_program(app, argc, argv, [&] {
    if (!*relations && !*truth && !*g2o && !*landmarks)
      throw CLI::RequiredError("--relations, --truth, --g2o or --landmarks");
    if (*pictures && !*relations && !*truth) throw CLI::RequiredError("--relations or --truth");
    if (*pictures) check_no_pictures(arguments);
    const Evaluation evaluation = evaluate(arguments);
    std::fputs((arguments.json ? to_json(evaluation) : to_text(evaluation)).c_str(), stdout);
    if (*pictures) draw(arguments, evaluation);
    if (const std::string failure = failure_of(evaluation); !failure.empty())
      throw std::runtime_error(failure);
  });
}
