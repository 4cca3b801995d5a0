#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "isthmus/reply_t.hpp"
#include "server/wire/questions/answerer.hpp"
#include "server/wire/questions/followed_paths.hpp"
#include "server/wire/questions/question.hpp"

namespace isthmus {

/// Bounds of what questions may take from the server.
struct QuestionLimits {
  std::size_t waiting = 64;          ///< of all askers
  std::size_t waiting_of_asker = 8;  ///< so that one asker's flood leaves room for others
  std::size_t refusals_per_s = 50;   ///< that are sent before the map is asked; others are only counted
  int map_time_share = 4;            ///< at most one in so many seconds goes into keeping the ground
  std::size_t followed = 32;         ///< paths, of all askers
  std::size_t followed_of_asker = 4;
  int follow_time_share = 4;  ///< at most one in so many seconds goes into looking at them again
};

/// Sends a message; called from several threads, and must not throw.
using SendReply = std::function<void(const std::string& channel, const std::vector<std::uint8_t>& bytes)>;

/// Takes questions about the map, and answers them on ISTHMUS_REPLY one after the other, in a thread of its
/// own and of low priority, from copies of the map: the engine never waits for it, and nothing of it is
/// journalled. Each question is answered once or refused with the reason, and counted. All but the
/// destructor: any thread.
class QuestionDesk {
 public:
  explicit QuestionDesk(SendReply send, QuestionLimits limits = {});
  /// Who is shown each reply that was sent, besides whoever asked; to be set before anybody asks.
  void show_to(std::function<void(const reply_t&)> viewer) { viewer_ = std::move(viewer); }
  ~QuestionDesk();

  /// The bytes of a request_t. `signer`: who signed it, as in [auth]; empty: nobody, and the asker is who it
  /// says.
  void take(std::span<const std::uint8_t> bytes, const std::string& signer);
  /// A request that was refused where it was received, for its signature.
  void refuse(const request_t& request, std::string_view reason);

  /// The newest map, of an event time in microseconds. It is looked at only once somebody asks.
  void offer(std::shared_ptr<const MapCopy> map, std::int64_t utime);
  /// What waits and what comes is refused (`stopped`); the question that is being answered is waited for.
  /// Once.
  void stop();

  /// Where a robot is now.
  void note(const RobotPose& pose);

  /// How many questions were answered ("answered"), or refused by reason.
  std::map<std::string, std::int64_t> counts() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Waiting {
    Question question;
    std::string asker;
    Clock::time_point deadline;
  };
  struct Work {
    std::optional<Waiting> next;         ///< none: paths that are followed are to be looked at
    std::shared_ptr<const MapCopy> map;  ///< none: the one there is will do
    std::int64_t map_utime = 0;
    RobotPoses robots, robots_before;
  };

  QuestionRefusal put(Question question, const std::string& signer);
  void loop(const std::stop_token& stop);
  std::optional<Work> next_work(const std::stop_token& stop);
  void keep_map(const Work& work);
  void answer(const Work& work);
  void follow(const Waiting& asked, reply_t& reply);
  void look_at_followed(const Work& work);
  void end(std::vector<FollowedPath> paths, FollowEnd why);
  void send(reply_t& reply);
  void count(const std::string& outcome);
  bool may_tell_refusal();

  SendReply send_;
  std::function<void(const reply_t&)> viewer_;
  QuestionLimits limits_;
  Answerer answerer_;                ///< the thread's own
  Clock::time_point next_map_time_;  ///< the thread's own: before it the map that it has will do
  bool has_map_ = false;             ///< the thread's own
  std::int64_t maps_ = 0;            ///< the thread's own: so many it has looked at
  FollowedPaths followed_;           ///< the thread's own
  Clock::time_point next_look_;      ///< the thread's own: at paths that are followed

  mutable std::mutex mutex_;
  std::condition_variable_any asked_;
  std::deque<Waiting> waiting_;
  std::shared_ptr<const MapCopy> offered_;
  std::int64_t offered_utime_ = 0;
  bool stopped_ = false;
  RobotPoses robots_, robots_at_offer_, robots_before_;
  std::map<std::string, std::int64_t> counts_;
  Clock::time_point refusals_since_;
  std::size_t refusals_ = 0;  ///< sent in the second that began then
  std::jthread thread_;       ///< last: it uses all above
};

}  // namespace isthmus
