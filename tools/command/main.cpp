#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <optional>
#include <stdexcept>

#include "server/program/command_line.hpp"
#include "server/program/finite_number.hpp"
#include "server/wire/live/lcm_link.hpp"
#include "tools/command/order.hpp"
#include "tools/command/send.hpp"

namespace {

using namespace isthmus;

struct Arguments {
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string key_file;
  double wait_s = 5;
  Verb verb = Verb::send_map;
  std::string what;  ///< a closure's id, or a robot
};

void add_verbs(CLI::App& app, Arguments& arguments) {
  const auto add = [&](Verb verb, const char* operand, const char* help) {
    CLI::App* command = app.add_subcommand(std::string(word(verb)), help);
    if (operand != nullptr) command->add_option(operand, arguments.what)->required();
    command->callback([&arguments, verb] { arguments.verb = verb; });
  };
  add(Verb::withdraw, "ID", "ID: undo an accepted closure");
  add(Verb::forbid, "ID", "ID: never accept this closure");
  add(Verb::allow, "ID_or_ROBOT", "ID or ROBOT: take back withdraw, forbid or drop");
  add(Verb::drop, "ROBOT", "ROBOT: leave a robot's data out of the map");
  add(Verb::refine, nullptr, "fit the whole map once more");
  add(Verb::send_map, nullptr, "publish the whole map");
}

CommandEvent order_of(const Arguments& arguments) {
  if (arguments.verb == Verb::allow) return allow_order(arguments.what);
  CommandEvent order;
  order.verb = arguments.verb;
  if (is_about_a_closure(order.verb)) order.closure = parse_closure_id(arguments.what);
  if (order.verb == Verb::drop) order.robot = parse_robot_name(arguments.what);
  return order;
}

std::int64_t wall_clock_utime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

std::string no_answer(const Arguments& arguments, bool any_server) {
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%g", arguments.wait_s);
  return "no answer within " + std::string(seconds) + " s: " +
         (any_server ? "the server is busy, or of an earlier version; the order may be carried out still"
                     : "is a server running on " + arguments.lcm_url + "?");
}

void send(const Arguments& arguments) {
  CommandEvent order = order_of(arguments);
  order.utime = wall_clock_utime();
  if (!log_file_of(arguments.lcm_url).empty()) {
    throw std::runtime_error(arguments.lcm_url + ": a log takes no commands");
  }
  std::optional<OperatorKey> key;
  if (!arguments.key_file.empty()) key = read_operator_key(arguments.key_file);
  if (key && !key->warning.empty())
    std::fprintf(stderr, "isthmus-command: warning: %s\n", key->warning.c_str());
  lcm::LCM lcm(arguments.lcm_url);
  if (!lcm.good()) throw std::runtime_error("cannot open LCM network " + arguments.lcm_url);
  const std::chrono::milliseconds wait(static_cast<int>(1e3 * arguments.wait_s));
  const OrderOutcome outcome = send_order(lcm, order, key, wait);
  if (outcome.answer && outcome.answer->done)
    std::printf("done: %s\n", to_text(order).c_str());
  else if (outcome.answer)
    throw std::runtime_error("refused: " + to_text(order) + ": " + outcome.answer->reason);
  else if (wait.count() == 0)
    std::printf("sent: %s\n", to_text(order).c_str());
  else
    throw std::runtime_error(no_answer(arguments, outcome.any_server));
}

/// "-3" is a wrong id and no option.
bool is_negative_number(const std::string& argument) {
  return argument.size() > 1 && argument[0] == '-' &&
         std::all_of(argument.begin() + 1, argument.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Sends an operator's order to isthmus-server, and tells what became of it.",
               "isthmus-command");
  Arguments arguments;
  app.require_subcommand(1);
  app.fallthrough();
  app.add_option("--lcm-url", arguments.lcm_url, "LCM network")->capture_default_str();
  app.add_option("--wait", arguments.wait_s, "seconds to wait for the server's answer; 0: none")
      ->check(finite_number & CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  app.add_option("--key", arguments.key_file, "file with the operator's name and key, to sign with");
  add_verbs(app, arguments);
  if (const auto negative = std::find_if(argv + 1, argv + argc, is_negative_number);
      negative != argv + argc) {
    std::fprintf(stderr, "isthmus-command: ids are not negative: %s\n", *negative);
    return exit_usage;
  }
  return run_program(app, argc, argv, [&] { send(arguments); });
}
