#include "server/wire/page/page_model.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/wire/message/wall_clock.hpp"
#include "server/wire/page/texts/exploration_text.hpp"
#include "server/wire/page/texts/page_texts.hpp"
#include "server/wire/questions/low_priority.hpp"

namespace isthmus {
namespace {

/// Milliseconds: versions of one run grow by a few a second.
std::int64_t number_of_run() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

/// Poses that wait to be shown; beyond, the map is recovered and nobody could follow.
constexpr std::size_t max_poses = 100'000;
/// Answers that wait for the next status to be shown.
constexpr std::size_t max_replies = 64;

}  // namespace

PageModel::PageModel(std::chrono::milliseconds interval, const std::string& journal_directory)
    : interval_(interval),
      run_(number_of_run()),
      tiles_(run_),
      past_(journal_directory, run_),
      version_(run_),
      thread_([this](const std::stop_token& stop) { loop(stop); }) {}

PageModel::~PageModel() {
  thread_.request_stop();
  thread_.join();
}

void PageModel::show(RobotPose pose) {
  {
    const std::lock_guard lock(mutex_);
    if (poses_.size() >= max_poses) return;
    poses_.push_back(std::move(pose));
  }
  given_.notify_one();
}

void PageModel::show(reply_t reply) {
  const std::lock_guard lock(mutex_);
  if (replies_.size() < max_replies) replies_.push_back(std::move(reply));
}

void PageModel::show(TeamGoals team) {
  const std::lock_guard lock(mutex_);
  team_ = std::move(team);
}

void PageModel::show(LiveView view) {
  std::optional<LiveView> newest(std::move(view));
  {
    const std::lock_guard lock(mutex_);
    view_.swap(newest);
  }
  given_.notify_one();
}

std::shared_ptr<const ShownMap> PageModel::shown() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

std::string PageModel::past_list() {
  const auto map = shown();
  return map ? past_.list(*map) : "[]";
}

void PageModel::loop(const std::stop_token& stop) {
  take_low_priority();
  while (true) {
    const auto next = std::chrono::steady_clock::now() + interval_;
    std::unique_lock lock(mutex_);
    if (!given_.wait(lock, stop, [&] { return view_ || !poses_.empty(); })) return;
    const std::vector<RobotPose> poses = std::exchange(poses_, {});
    std::optional<LiveView> view = std::exchange(view_, std::nullopt);
    lock.unlock();
    for (const RobotPose& pose : poses) trails_.add(pose);
    if (view) take(std::move(*view));
    if (const auto map = shown(); map && !poses.empty()) bulletin_.post("robots", robots_text(trails_, *map));
    lock.lock();
    given_.wait_until(lock, stop, next, [] { return false; });
    if (stop.stop_requested()) return;
  }
}

void PageModel::take(LiveView view) {
  const std::shared_ptr<const ShownMap> before = shown();
  const auto fresh = std::make_shared<const ShownMap>(shown_map(std::move(view), before.get(), ++version_));
  tiles_.update(fresh->map());
  follow_drops(*fresh, !before);
  std::vector<reply_t> replies;
  std::optional<TeamGoals> team;
  {
    const std::lock_guard lock(mutex_);
    shown_ = fresh;
    replies = std::exchange(replies_, {});
    team = team_;
  }
  for (const reply_t& reply : replies) asked_.add(reply);
  bulletin_.post("exploration", team ? exploration_text(*team, *fresh) : "null");
  post(*fresh);
}

/// What a robot drove before it was dropped is not its way any more, on whose patches ever; once it is
/// allowed again, and when the server has begun, it is where the map has it. On a finished map a robot may be
/// anywhere until it is found.
void PageModel::follow_drops(const ShownMap& map, bool is_first) {
  const std::set<std::string> before = std::exchange(dropped_, left_out_robots(map.map()));
  for (const std::string& robot : dropped_)
    if (!before.contains(robot)) trails_.forget(robot);
  const bool any_is_back = !std::ranges::includes(dropped_, before);
  if ((is_first || any_is_back) && !map.view.frozen) trails_.add_from_map(trails_of(map));
}

void PageModel::post(const ShownMap& map) {
  bulletin_.post("asked", asked_.text(map, wall_clock_utime()));
  bulletin_.post("islands", islands_text(map, tiles_.islands()));
  bulletin_.post("trails", trails_text(trails_, map));
  bulletin_.post("tags", tags_text(map));
  bulletin_.post("annotations", annotations_text(map));
  bulletin_.post("closures", closures_text(map));
  bulletin_.post("sightings", sightings_text(trails_, map));
  bulletin_.post("status", status_text(map));
  bulletin_.post("meeting", meeting_text(map));
  bulletin_.post("robots", robots_text(trails_, map));
  bulletin_.post("past", nlohmann::json(past_.snapshots()).dump());
}

}  // namespace isthmus
