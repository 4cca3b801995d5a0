#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "server/program/command_line.hpp"
#include "server/program/values.hpp"
#include "server/wire/live/lcm_link.hpp"
#include "server/wire/message/reason_sentence.hpp"
#include "tools/command/heard_server.hpp"
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
  /// Of what is drawn on the map, or of where a robot is; none: an order of a verb.
  std::function<Order(const Arguments&)> drawn;
  std::string name, at;
  std::int32_t island = -1, patch = -1;
  bool replace = false;
  double max_speed_m_s = 0, sigma_m = 1, sigma_deg = 30;
};

/// Where coordinates are: in an island's plane, or in a patch's frame.
void add_frame(CLI::App& command, Arguments& arguments) {
  CLI::Option_group* group = command.add_option_group("frame", "Where coordinates are: one of them");
  group->require_option(1);
  group->add_option("--island", arguments.island, "in the plane of this island: the lowest patch id on it")
      ->check(integer_from(0));
  group->add_option("--patch", arguments.patch, "in the frame of this patch")->check(integer_from(0));
}

AnnotationEvent annotation_of(const Arguments& arguments, AnnotationKind kind,
                              const std::vector<Eigen::Vector2d>& points) {
  AnnotationEvent order;
  order.kind = kind;
  order.name = parse_annotation_name(arguments.name);
  order.replace = arguments.replace;
  order.island = IslandId{arguments.island};
  for (const Eigen::Vector2d& point : points) order.points.push_back({PatchId{arguments.patch}, point});
  return order;
}

Order place_order(const Arguments& arguments) {
  const Pose pose = parse_pose(arguments.at);
  AnnotationEvent order = annotation_of(arguments, AnnotationKind::place, {position(pose)});
  order.yaw_rad = pose.yaw;
  return order;
}

Order zone_order(const Arguments& arguments) {
  const bool slow = arguments.max_speed_m_s > 0;
  AnnotationEvent order = annotation_of(arguments, slow ? AnnotationKind::speed : AnnotationKind::keep_out,
                                        parse_points(arguments.at));
  order.max_speed_m_s = arguments.max_speed_m_s;
  return order;
}

Order erase_order(const Arguments& arguments) { return annotation_of(arguments, AnnotationKind::erase, {}); }

Order initial_pose_order(const Arguments& arguments) {
  InitialPoseEvent order;
  order.robot = parse_robot_name(arguments.name);
  order.island = IslandId{arguments.island};
  order.patch = PatchId{arguments.patch};
  order.pose = parse_pose(arguments.at);
  order.sigma_m = arguments.sigma_m;
  order.sigma_rad = arguments.sigma_deg * std::numbers::pi / 180;
  return order;
}

/// What is drawn on the map by name.
void add_drawing(CLI::App& app, Arguments& arguments) {
  const auto add = [&](const char* verb, const char* help, Order (*order)(const Arguments&)) {
    CLI::App* command = app.add_subcommand(verb, help);
    command->add_option("NAME", arguments.name)->required();
    command->callback([&arguments, order] { arguments.drawn = order; });
    return command;
  };
  const auto add_drawn = [&](CLI::App* command, const char* option, const char* help) {
    command->add_option(option, arguments.at, help)->required();
    command->add_flag("--replace", arguments.replace, "take the place of the one of that name");
    add_frame(*command, arguments);
  };
  add_drawn(add("place", "NAME: name a place", place_order), "--at", "X,Y or X,Y,YAW: metres, degrees");
  const char* corners = "\"X,Y X,Y X,Y …\": in turn, metres";
  add_drawn(add("keep-out", "NAME: draw a zone that no path leads through", zone_order), "--corners",
            corners);
  CLI::App* speed = add("speed", "NAME: draw a zone in which robots are told to drive slowly", zone_order);
  add_drawn(speed, "--corners", corners);
  speed->add_option("--max", arguments.max_speed_m_s, "m/s")->required()->check(number_in(0.01, 100.0));
  add("erase", "NAME: take a place or zone away", erase_order);
  CLI::App* pose = add("pose", "ROBOT: say where it is on a finished map", initial_pose_order);
  pose->add_option("--at", arguments.at, "X,Y or X,Y,YAW: metres, degrees")->required();
  pose->add_option("--sigma", arguments.sigma_m, "standard deviation of x and of y, m")
      ->check(number_in(0.01, 10.0))
      ->capture_default_str();
  pose->add_option("--sigma-yaw", arguments.sigma_deg, "of the yaw, degrees; 180: not known")
      ->check(number_in(0.1, 180.0))
      ->capture_default_str();
  add_frame(*pose, arguments);
}

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

Order order_of(const Arguments& arguments) {
  if (arguments.drawn) return arguments.drawn(arguments);
  if (arguments.verb == Verb::allow) return allow_order(arguments.what);
  CommandEvent order;
  order.verb = arguments.verb;
  if (is_about_a_closure(order.verb)) order.closure = parse_closure_id(arguments.what);
  if (order.verb == Verb::drop) order.robot = parse_robot_name(arguments.what);
  return order;
}

/// One that cannot be read is wrong usage.
Order read_order(const Arguments& arguments) {
  try {
    return order_of(arguments);
  } catch (const std::runtime_error& error) {
    throw UsageError(error.what());
  }
}

std::int64_t wall_clock_utime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

/// Of an order that is done, with what is to be known of it.
std::string done_text(const Order& order, const answer_t& answer) {
  std::string text = "done: " + to_text(order);
  const std::string_view remark = sentence_of_order(answer.reason);
  return remark.empty() ? text : text + ": " + std::string(remark);
}

void send(const Arguments& arguments) {
  Order order = read_order(arguments);
  if (const std::string wrong = why_unreadable(order); !wrong.empty()) throw UsageError(wrong);
  std::visit([](auto& body) { body.utime = wall_clock_utime(); }, order);
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
    std::printf("%s\n", done_text(order, *outcome.answer).c_str());
  else if (outcome.answer)
    throw std::runtime_error(
        "refused: " + to_text(order) + ": " +
        with_sentence(outcome.answer->reason, sentence_of_order(outcome.answer->reason)));
  else if (wait.count() == 0)
    std::printf("sent: %s\n", to_text(order).c_str());
  else
    throw std::runtime_error(silence_text(arguments.wait_s, outcome.any_server, arguments.lcm_url) +
                             "; the order may be carried out still");
}

/// "-3" is a wrong id and no option.
bool is_negative_number(const std::string& argument) {
  return argument.size() > 1 && argument[0] == '-' &&
         std::all_of(argument.begin() + 1, argument.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// The first negative number that is no option's value: those have bounds of their own.
std::optional<std::string> negative_id(const std::vector<std::string>& arguments) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const bool is_value = i > 0 && arguments[i - 1].starts_with("--");
    if (!is_value && is_negative_number(arguments[i])) return arguments[i];
  }
  return std::nullopt;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Sends an operator's order to isthmus-server, and tells what became of it.",
               "isthmus-command");
  Arguments arguments;
  app.require_subcommand(1);
  app.fallthrough();
  app.add_option("--lcm-url", arguments.lcm_url, "LCM network")->capture_default_str();
  app.add_option("--wait", arguments.wait_s, "to wait for the server's answer (5); 0: none")
      ->type_name("SECONDS")
      ->check(number_in(0.0, 3600.0));
  app.add_option("--key", arguments.key_file, "file with the operator's name and key, to sign with");
  add_verbs(app, arguments);
  add_drawing(app, arguments);
  if (const auto negative = negative_id({argv + 1, argv + argc})) {
    std::fprintf(stderr, "isthmus-command: ids are not negative: %s\n", negative->c_str());
    return exit_usage;
  }
  return run_program(app, argc, argv, [&] { send(arguments); });
}
