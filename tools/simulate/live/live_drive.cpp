#include "tools/simulate/live/live_drive.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <memory>
#include <span>
#include <stdexcept>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "server/client/goal.hpp"
#include "server/output/format/atomic_file.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/network/lcm_url.hpp"
#include "tools/simulate/live/drive_picture.hpp"
#include "tools/simulate/live/live_team.hpp"
#include "tools/simulate/live/radio.hpp"
#include "tools/simulate/live/reachable_ground.hpp"
#include "tools/simulate/live/seen_ground.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

/// So long nobody may have anything to do before the run is over.
constexpr double idle_s = 10;
/// A robot that has stood out of reach for so long comes back, so far at a time.
constexpr double come_back_s = 5, come_back_m = 5;

std::chrono::nanoseconds seconds(double value) { return std::chrono::nanoseconds(std::llround(1e9 * value)); }

std::vector<Pose> starts_of(const Scenario& scenario, const LiveDriveOptions& options) {
  const std::size_t robots = options.robots > 0 ? options.robots : scenario.robots.size();
  return options.side_by_side ? starts_side_by_side(scenario, robots, options.clearance_m)
                              : own_starts(scenario, robots);
}

/// What a robot heard last on its channel.
class GoalEar {
 public:
  GoalEar(lcm_t* link, const std::string& robot) : link_(link) {
    subscription_ = lcm_subscribe(link_, (robot + "_GOAL").c_str(), note, this);
  }
  ~GoalEar() { lcm_unsubscribe(link_, subscription_); }
  GoalEar(const GoalEar&) = delete;
  GoalEar& operator=(const GoalEar&) = delete;

  /// Nothing where nothing was heard since.
  std::optional<goal_t> take() { return std::exchange(heard_, std::nullopt); }

 private:
  static void note(const lcm_recv_buf_t* buffer, const char*, void* self) noexcept {
    const std::span bytes(static_cast<const std::uint8_t*>(buffer->data), buffer->data_size);
    if (auto goal = read_goal(bytes)) static_cast<GoalEar*>(self)->heard_ = std::move(goal);
  }

  lcm_t* link_;
  lcm_subscription_t* subscription_ = nullptr;
  std::optional<goal_t> heard_;
};

class LiveDrive {
 public:
  LiveDrive(const Scenario& scenario, std::uint64_t seed, const LiveDriveOptions& options)
      : scenario_(scenario),
        options_(options),
        lcm_(complete_lcm_url(options.lcm_url)),
        team_(scenario, seed, starts_of(scenario, options)),
        ground_(scenario.plan, team_.caster(), position(team_[0].robot.world_from_robot()),
                team_[0].robot.plan().radius_m + options.clearance_m),
        seen_(ground_),
        last_ids_(team_.size(), 0),
        told_finished_(team_.size(), 0) {
    if (!lcm_.good()) throw std::runtime_error(options.lcm_url + ": the network cannot be opened");
    for (std::size_t i = 0; i < team_.size(); ++i)
      ears_.push_back(std::make_unique<GoalEar>(lcm_.getUnderlyingLCM(), team_[i].name()));
    const Eigen::Vector2d base = position(team_[0].robot.world_from_robot());
    for (std::size_t i = 0; i < team_.size(); ++i)
      radios_.push_back({{base, options.radio_range_m}, true, 0});
    score_.reachable_m2 = ground_.area_m2();
    if (!options.pictures.empty()) make_directory(options.pictures);
  }

  LiveDriveScore run() {
    const Clock::time_point begun = Clock::now();
    Clock::time_point next = begun;
    while (!score_.finished && team_.time_s() < options_.max_s) {
      team_.sense([this](decltype(Event::body) body) { send(std::move(body)); });
      while (lcm_.handleTimeout(0) > 0) {
      }
      for (std::size_t i = 0; i < team_.size(); ++i) hear(i);
      score_.finished =
          std::ranges::all_of(told_finished_, std::identity()) && team_.time_s() - busy_s_ >= idle_s;
      picture_if_due(score_.finished);
      team_.move();
      next += seconds(LiveTeam::tick_s / options_.speed);
      keep_time(next);
    }
    picture_if_due(true);
    score_.end_s = team_.time_s();
    score_.wall_s = std::chrono::duration<double>(Clock::now() - begun).count();
    score_.share = seen_.share();
    score_.way_m = team_.way_m();
    score_.touched_walls = team_.touched_walls();
    score_.touched_robots = team_.touched_robots();
    return score_;
  }

 private:
  void send(decltype(Event::body) body) {
    if (const auto* scan = std::get_if<ScanEvent>(&body)) see(*scan);
    const std::size_t i = speaker(body);
    const Eigen::Vector2d here = position(team_[i].robot.world_from_robot());
    for (const Message& message : radios_[i].radio.say(encode({team_.utime(), std::move(body)}), here))
      lcm_.publish(message.channel, message.bytes.data(), static_cast<unsigned>(message.bytes.size()));
  }

  /// Whose message it is; robots alone send any.
  std::size_t speaker(const decltype(Event::body)& body) const {
    const std::string name = std::visit(
        [](const auto& event) -> std::string {
          if constexpr (requires { event.robot; })
            return event.robot;
          else
            return "";
        },
        body);
    for (std::size_t i = 0; i < team_.size(); ++i)
      if (team_[i].name() == name) return i;
    throw std::logic_error("a message of no robot");
  }

  void hear(std::size_t i) {
    Heard& heard = radios_[i];
    const auto goal = ears_[i]->take();
    const bool reached = heard.radio.reaches(position(team_[i].robot.world_from_robot()));
    score_.out_of_reach += heard.reached && !reached;
    heard.reached = reached;
    if (reached && goal) obey(i, *goal);
    Pilot& pilot = team_[i].pilot;
    if (reached || pilot.is_driving()) heard.stands_since_s = team_.time_s();
    if (team_.time_s() - heard.stands_since_s < come_back_s) return;
    pilot.back_off(come_back_m, 0);
    heard.stands_since_s = team_.time_s();
  }

  void see(const ScanEvent& event) {
    for (std::size_t i = 0; i < team_.size(); ++i)
      if (team_[i].name() == event.robot)
        seen_.add(team_[i].robot.world_from_robot(), event.scan, team_[i].robot.plan().laser.laser);
  }

  /// What is said is in the frame of the map as it was when the robot was at a pose that it knows by its
  /// odometry.
  void obey(std::size_t i, const goal_t& goal) {
    told_finished_[i] = goal.reason == "finished";
    if (!told_finished_[i]) busy_s_ = team_.time_s();
    score_.goals += goal.id != last_ids_[i];
    last_ids_[i] = goal.id;
    LiveTeam::Member& member = team_[i];
    const auto odom_from_robot = member.odom_from_robot_at(goal.pose_utime);
    if (!odom_from_robot || member.pilot.is_backing_off()) return;
    const auto pose = [](const path_pose_t& place) {
      return Pose{place.map_from_robot[0], place.map_from_robot[1], place.map_from_robot[2]};
    };
    member.pilot.localise(*odom_from_robot * inverse(pose(goal.pose)));
    if (goal.poses.empty()) return member.pilot.halt();
    std::vector<Eigen::Vector2d> points;
    for (const path_pose_t& place : goal.poses) points.push_back(position(pose(place)));
    std::optional<double> heading;
    if (goal.at_goal && goal.has_goal) heading = pose(goal.goal).yaw;
    member.pilot.follow(std::move(points), heading);
  }

  /// A machine that does not keep up makes the run slower, and no robot blind.
  void keep_time(Clock::time_point& next) {
    constexpr double late_s = 0.1;
    const Clock::time_point now = Clock::now();
    if (now > next + seconds(late_s)) {
      ++score_.late_ticks;
      next = now;
    }
    std::this_thread::sleep_until(next);
  }

  void picture_if_due(bool is_last) {
    if (options_.pictures.empty() || (!is_last && team_.time_s() < next_picture_s_)) return;
    next_picture_s_ = team_.time_s() + options_.picture_s;
    draw_drive(scenario_.plan, team_, ground_, seen_, options_.pictures);
  }

  const Scenario& scenario_;
  const LiveDriveOptions& options_;
  lcm::LCM lcm_;
  LiveTeam team_;
  ReachableGround ground_;
  SeenGround seen_;
  std::vector<std::int64_t> last_ids_;  // by robot
  std::vector<std::uint8_t> told_finished_;
  std::vector<std::unique_ptr<GoalEar>> ears_;
  struct Heard {
    Radio radio;
    bool reached = true;
    double stands_since_s = 0;  ///< out of reach
  };
  std::vector<Heard> radios_;
  LiveDriveScore score_;
  double busy_s_ = 0, next_picture_s_ = 0;
};

}  // namespace

LiveDriveScore drive_live(const Scenario& scenario, std::uint64_t seed, const LiveDriveOptions& options) {
  return LiveDrive(scenario, seed, options).run();
}

}  // namespace isthmus
