#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "server/client/ask.hpp"
#include "server/program/command_line.hpp"
#include "server/program/values.hpp"
#include "server/wire/message/reason_sentence.hpp"
#include "server/wire/questions/question.hpp"
#include "tools/ask/reply_text.hpp"
#include "tools/command/heard_server.hpp"
#include "tools/command/send.hpp"

namespace {

using namespace isthmus;

struct Arguments {
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string key_file;
  request_t request = question("", "isthmus-ask", "");
};

void add_target(CLI::App& command, request_t& request) {
  const auto set = [&request](const char* target) {
    return [&request, target](auto) { request.target = target; };
  };
  CLI::Option_group* group = command.add_option_group("target", "To where: one of them");
  group->require_option(1, 0);
  const std::array targets = {
      group->add_option("--to-patch", request.target_patch, "the origin of a patch")->each(set("patch")),
      group->add_option("--to-tag", request.target_barcode, "a fixed tag's barcode")->each(set("tag")),
      group->add_option("--to-place", request.target_place, "a named place")->each(set("place")),
      group->add_option("--to-robot", request.target_robot, "where a robot is")->each(set("robot")),
      group->add_flag_callback(
          "--home", [&request] { request.target = "home"; }, "where the robot began on its island")};
  for (CLI::Option* one : targets)
    for (CLI::Option* other : targets)
      if (one != other) one->excludes(other);
}

void add_footprint(CLI::App& command, request_t& request) {
  command.add_option("--radius", request.radius_m, "of the robot, m")
      ->check(finite_number())
      ->capture_default_str();
  command.add_option("--clearance", request.clearance_m, "from walls, m")
      ->check(finite_number())
      ->capture_default_str();
}

void add_follow(CLI::App& command, request_t& request) {
  command
      .add_option("--follow", request.follow_s,
                  "so many seconds: prints also what becomes of it, until the robot is there")
      ->check(number_in(0.0, max_follow_s));
}

CLI::App& add_kind(CLI::App& app, request_t& request, const char* kind, const char* help, bool of_a_robot) {
  CLI::App* command = app.add_subcommand(kind, help);
  if (of_a_robot) command->add_option("ROBOT", request.robot, "from where it is")->required();
  command->callback([&request, kind] { request.kind = kind; });
  return *command;
}

void add_kinds(CLI::App& app, request_t& request) {
  CLI::App& path = add_kind(app, request, "path", "a way for a robot", true);
  add_target(path, request);
  add_footprint(path, request);
  add_follow(path, request);
  add_target(add_kind(app, request, "relative_pose", "where something is as seen from a robot", true),
             request);
  CLI::App& back = add_kind(app, request, "retro_traverse", "a robot's own way back", true);
  add_follow(back, request);
  back.add_option("--since", request.since,
                  "to where it was at this time, its clock, microseconds; 0: its start");
  add_footprint(add_kind(app, request, "frontiers", "free ground that borders on the unseen", true), request);
  add_kind(app, request, "map_version", "which map this is", false);
  add_kind(app, request, "changes", "patches that changed", false)
      .add_option("VERSION", request.since, "since this version of the map")
      ->required();
}

std::runtime_error refused(const reply_t& reply) {
  return std::runtime_error("refused: " + with_sentence(reply.reason, sentence_of_question(reply.reason)));
}

/// Where the question is refused for good there is nothing to follow.
bool print_update(const reply_t& reply) {
  if (!reply.done && !reply.followed && reply.update == 0) throw refused(reply);
  std::fputs(update_text(reply).c_str(), stdout);
  std::fflush(stdout);
  return true;
}

void ask_server(const Arguments& arguments) {
  std::optional<QuestionKey> key;
  if (!arguments.key_file.empty()) {
    const OperatorKey read = read_operator_key(arguments.key_file);
    if (!read.warning.empty()) std::fprintf(stderr, "isthmus-ask: warning: %s\n", read.warning.c_str());
    key = {read.name, read.key};
  }
  lcm::LCM lcm(arguments.lcm_url);
  if (!lcm.good()) throw std::runtime_error("cannot open LCM network " + arguments.lcm_url);
  const HeardServer server(lcm);
  const auto silent = [&] {
    return std::runtime_error(silence_text(arguments.request.timeout_s, server.any(), arguments.lcm_url));
  };
  if (arguments.request.follow_s > 0) {
    if (!follow(lcm, arguments.request, print_update, key)) throw silent();
    return;
  }
  const std::optional<reply_t> reply = ask(lcm, arguments.request, key);
  if (!reply) throw silent();
  if (!reply->done) throw refused(*reply);
  std::fputs(to_text(*reply).c_str(), stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Asks isthmus-server about the map, as robots do, and prints the answer as CSV.",
               "isthmus-ask");
  Arguments arguments;
  app.require_subcommand(1);
  app.fallthrough();
  app.add_option("--lcm-url", arguments.lcm_url, "LCM network")->capture_default_str();
  app.add_option("--wait", arguments.request.timeout_s, "seconds to wait for the answer")
      ->check(number_in(0.01, 60.0))
      ->capture_default_str();
  app.add_option("--key", arguments.key_file,
                 "file with a name and key of the server's [auth], to sign with");
  add_kinds(app, arguments.request);
  return run_program(app, argc, argv, [&] { ask_server(arguments); });
}
