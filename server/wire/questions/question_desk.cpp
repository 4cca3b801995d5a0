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

}  // namespace

QuestionDesk::QuestionDesk(SendReply send, QuestionLimits limits)
    : send_(std::move(send)), limits_(limits), thread_([this](const std::stop_token& stop) { loop(stop); }) {}

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
      answer(*work);
    } catch (const std::exception&) {
      refuse(work->next->question.request, word(QuestionRefusal::failed));
    }
  }
}

/// The next question, with a newer map where it is time for one; nothing once stopped. Before the first map
/// questions wait.
std::optional<QuestionDesk::Work> QuestionDesk::next_work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const auto ready = [this] { return !waiting_.empty() && (has_map_ || offered_); };
  if (!asked_.wait(lock, stop, ready) || stop.stop_requested()) return std::nullopt;
  Work work;
  work.next = std::move(waiting_.front());
  waiting_.pop_front();
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
  const Clock::time_point done = Clock::now();
  next_map_time_ = done + (limits_.map_time_share - 1) * (done - begun);
}

void QuestionDesk::answer(const Work& work) {
  const Waiting& next = *work.next;
  const auto too_late = [&] { return Clock::now() > next.deadline; };
  if (too_late()) return refuse(next.question.request, word(QuestionRefusal::timed_out));
  reply_t reply = answerer_.answer(next.question, work.robots, work.robots_before);
  if (too_late()) return refuse(next.question.request, word(QuestionRefusal::timed_out));
  count(reply.done ? answered : reply.reason);
  send(reply);
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
