#include "server/wire/questions/question_desk.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include "server/engine/input/robot_name.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/message/wall_clock.hpp"
#include "server/wire/questions/low_priority.hpp"

namespace isthmus {
namespace {

using namespace std::chrono_literals;

constexpr const char* answered = "answered";
constexpr const char* updated = "updated";
/// So often paths that are followed are looked at, one each time.
constexpr auto look_again = 20ms;

}  // namespace

QuestionDesk::QuestionDesk(SendReply send, QuestionLimits limits)
    : send_(std::move(send)),
      limits_(limits),
      followed_(limits.followed, limits.followed_of_asker),
      thread_([this](const std::stop_token& stop) { loop(stop); }) {}

QuestionDesk::~QuestionDesk() { stop(); }

void QuestionDesk::stop() {
  std::deque<Waiting> left;
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(stopped_, true)) return;
    left = std::exchange(waiting_, {});
  }
  thread_.request_stop();
  thread_.join();
  for (const Waiting& waiting : left) refuse(waiting.question.request, word(QuestionRefusal::stopped));
  end(followed_.take_all(), FollowEnd::stopped);
}

void QuestionDesk::take(std::span<const std::uint8_t> bytes, const std::string& signer) {
  std::optional<request_t> request = read_request(bytes);
  if (!request) return count(std::string(word(QuestionRefusal::bad_bytes)));  // whose it is nobody knows
  QuestionReading reading = read_question(*request);
  const QuestionRefusal refusal =
      reading.question ? put(std::move(*reading.question), signer) : reading.refusal;
  if (refusal != QuestionRefusal::none) refuse(*request, word(refusal));
}

QuestionRefusal QuestionDesk::put(Question question, const std::string& signer) {
  Waiting waiting{std::move(question), signer, {}};
  if (signer.empty()) waiting.asker = upper_case(waiting.question.request.asker);
  const std::chrono::duration<double> timeout(waiting.question.request.timeout_s);
  waiting.deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(timeout);
  const std::lock_guard lock(mutex_);
  if (stopped_) return QuestionRefusal::stopped;
  const auto of_asker = std::count_if(waiting_.begin(), waiting_.end(),
                                      [&](const Waiting& other) { return other.asker == waiting.asker; });
  if (waiting_.size() >= limits_.waiting || static_cast<std::size_t>(of_asker) >= limits_.waiting_of_asker)
    return QuestionRefusal::queue_full;
  waiting_.push_back(std::move(waiting));
  asked_.notify_one();
  return QuestionRefusal::none;
}

void QuestionDesk::refuse(const request_t& request, std::string_view reason) {
  count(std::string(reason));
  if (!may_tell_refusal()) return;
  reply_t reply = reply_to(request);
  reply.reason = reason;
  send(reply);
}

/// A flood of bad questions is not answered by a flood of replies.
bool QuestionDesk::may_tell_refusal() {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (now - refusals_since_ >= 1s) {
    refusals_since_ = now;
    refusals_ = 0;
  }
  return refusals_++ < limits_.refusals_per_s;
}

void QuestionDesk::offer(std::shared_ptr<const MapCopy> map, std::int64_t utime) {
  const std::lock_guard lock(mutex_);
  offered_.swap(map);
  offered_utime_ = utime;
  robots_at_offer_ = robots_;
  asked_.notify_one();  // one who asked before there was any map
}

void QuestionDesk::note(const RobotPose& pose) {
  const std::lock_guard lock(mutex_);
  robots_[pose.robot] = pose;
}

std::map<std::string, std::int64_t> QuestionDesk::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void QuestionDesk::loop(const std::stop_token& stop) {
  take_low_priority();
  while (const std::optional<Work> work = next_work(stop)) {
    try {
      keep_map(*work);
      if (work->next) answer(*work);
      if (!followed_.empty()) look_at_followed(*work);
    } catch (const std::exception&) {
      if (work->next) refuse(work->next->question.request, word(QuestionRefusal::failed));
    }
  }
}

/// The next question, with a newer map where it is time for one; nothing once stopped. Before the first map
/// questions wait. None, while paths are followed: it is time to look at them.
std::optional<QuestionDesk::Work> QuestionDesk::next_work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const auto ready = [this] { return !waiting_.empty() && (has_map_ || offered_); };
  if (followed_.empty())
    asked_.wait(lock, stop, ready);
  else
    asked_.wait_for(lock, stop, look_again, ready);
  if (stop.stop_requested()) return std::nullopt;
  Work work;
  if (ready()) {
    work.next = std::move(waiting_.front());
    waiting_.pop_front();
  }
  if (offered_ && (!has_map_ || Clock::now() >= next_map_time_)) {
    work.map = std::exchange(offered_, nullptr);
    work.map_utime = offered_utime_;
    robots_before_ = robots_at_offer_;
  }
  work.robots = robots_;
  work.robots_before = robots_before_;
  return work;
}

void QuestionDesk::keep_map(const Work& work) {
  if (!work.map) return;
  const Clock::time_point begun = Clock::now();
  answerer_.update(work.map, work.map_utime);
  has_map_ = true;
  ++maps_;
  const Clock::time_point done = Clock::now();
  next_map_time_ = done + (limits_.map_time_share - 1) * (done - begun);
}

void QuestionDesk::answer(const Work& work) {
  const Waiting& next = *work.next;
  const auto too_late = [&] { return Clock::now() > next.deadline; };
  if (too_late()) return refuse(next.question.request, word(QuestionRefusal::timed_out));
  reply_t reply = answerer_.answer(next.question, work.robots, work.robots_before);
  if (too_late()) return refuse(next.question.request, word(QuestionRefusal::timed_out));
  end(followed_.take(next.asker, next.question.request.id), FollowEnd::replaced);
  if (next.question.request.follow_s > 0) follow(next, reply);
  count(reply.done ? answered : reply.reason);
  send(reply);
}

/// Whoever is told that there is no way is told when there is one.
void QuestionDesk::follow(const Waiting& asked, reply_t& reply) {
  if (reply.reason == word(Refusal::bad_value)) return;
  if (!followed_.has_room(asked.asker)) {
    reply = reply_to(asked.question.request);
    reply.reason = word(QuestionRefusal::too_many_followed);
    return;
  }
  reply.followed = 1;
  const std::chrono::duration<double> time(asked.question.request.follow_s);
  followed_.add({asked.question, asked.asker,
                 Clock::now() + std::chrono::duration_cast<Clock::duration>(time), reply, maps_});
}

void QuestionDesk::end(std::vector<FollowedPath> paths, FollowEnd why) {
  for (FollowedPath& path : paths) {
    reply_t reply = path.last(why);
    send(reply);
  }
}

/// One after the other, each once on a map, in its share of the time.
void QuestionDesk::look_at_followed(const Work& work) {
  const Clock::time_point begun = Clock::now();
  end(followed_.take_ended(begun), FollowEnd::expired);
  if (begun < next_look_) return;
  FollowedPath* const path = followed_.next(maps_);
  if (!path) return;
  auto reply = answerer_.update_of(path->question, path->told, work.robots, work.robots_before);
  if (reply) {
    const bool arrived = reply->change == word(PathChange::arrived);
    path->number(*reply, !arrived);
    count(updated);
    send(*reply);
    if (arrived) followed_.erase(path);
  }
  const Clock::time_point done = Clock::now();
  next_look_ = done + (limits_.follow_time_share - 1) * (done - begun);
}

void QuestionDesk::send(reply_t& reply) {
  reply.utime = wall_clock_utime();
  send_(reply_channel, encoded(reply));
  if (viewer_) viewer_(reply);
}

void QuestionDesk::count(const std::string& outcome) {
  const std::lock_guard lock(mutex_);
  counts_[outcome] += 1;
}

}  // namespace isthmus
