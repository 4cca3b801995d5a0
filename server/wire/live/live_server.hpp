#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/engine/engine.hpp"
#include "server/output/latency.hpp"
#include "server/wire/goals/goal_publisher.hpp"
#include "server/wire/intake/admission.hpp"
#include "server/wire/intake/event_clock.hpp"
#include "server/wire/intake/inbox.hpp"
#include "server/wire/intake/settlement.hpp"
#include "server/wire/intake/spool.hpp"
#include "server/wire/journal/journal.hpp"
#include "server/wire/journal/recovery/crash_guard.hpp"
#include "server/wire/journal/recovery/recovery.hpp"
#include "server/wire/live/answers.hpp"
#include "server/wire/live/map_publisher.hpp"
#include "server/wire/live/rendezvous_publisher.hpp"
#include "server/wire/live/snapshot_process.hpp"
#include "server/wire/questions/question_desk.hpp"
#include "server/wire/trust/authenticator.hpp"
#include "server/wire/watch/closure_log.hpp"
#include "server/wire/watch/live_warnings.hpp"
#include "server/wire/watch/log_line.hpp"
#include "server/wire/watch/mistakes.hpp"

namespace isthmus {

/// Who is shown what the server does. Called from its thread, which waits: they must be quick. Empty: nobody.
struct Viewers {
  std::function<void(const RobotPose&)> pose;
  /// What the engine took.
  std::function<void(const Event&)> event;
  /// With each status. `latency_p99_s`: of the engine's events so far.
  std::function<void(std::shared_ptr<const MapCopy>, const status_t&, double latency_p99_s)> map;
  /// What a team that explores was told. From another thread.
  std::function<void(TeamGoals)> goals;
  /// What became of an order, by its stamp; none: it is done, with a remark or an empty one (answer_t).
  std::function<void(std::int64_t order_utime, DropReason, const std::string& remark)> order;
};

struct LiveOptions {
  std::string toml;               ///< the configuration's text; must parse; empty: that of a found journal
  std::string journal_directory;  ///< empty: no journal; one that holds a journal: it goes on
  bool frozen = false;            ///< the journal is only read: robots are localised in its map
  std::string output_directory;   ///< empty: nothing is exported
  /// The time of ticks, and of messages as they are received; none where these carry the time of a log.
  std::shared_ptr<EventClock> clock;
  std::int64_t start_utime = 0;  ///< receive time of the configuration where there is no clock
  std::chrono::milliseconds tick_interval{100};
  std::chrono::milliseconds status_interval{1000};
  MapPublisherOptions map;
  JournalOptions journal;
  bool snapshots = false;            ///< isthmus-snapshot is run beside the server, at each closed segment
  int keep_snapshots = 10;           ///< see SnapshotPolicy
  std::optional<int> keep_segments;  ///< see SnapshotPolicy
  AdmissionLimits admission;
  Log log;
  std::function<void(const Event&)> before_event;  ///< see handle_guarded
  /// Messages that the network refused so far, for the status; empty: none.
  std::function<std::int64_t()> publish_failures;
  /// Takes the metrics with each status; empty: nobody does.
  std::function<void(std::string metrics)> metrics;
  Viewers viewers;
  /// Shared with whoever receives; none: only what arrives in the inbox is looked at.
  std::shared_ptr<Mistakes> mistakes;
  /// Gets copies of the map and poses of robots, and answers by them; none: nobody asks.
  std::shared_ptr<QuestionDesk> questions;
};

/// The engine at work on what arrives in an inbox: checks and decodes each message, journals it, lets the
/// engine take it, and publishes. Runs in one thread; the map is published from another.
///
/// The engine sees the events of the journal and no others, in its order and with its times, so that a replay
/// of the journal gives the same map.
class LiveServer {
 public:
  /// Throws std::runtime_error where the configuration is wrong or another than the journal's, or the journal
  /// cannot be begun or read.
  LiveServer(LiveOptions options, Inbox& inbox, Publish publish);
  ~LiveServer();

  /// Replays the journal that was found; then handles what arrives, until the inbox is
  /// closed and empty; then finishes the map and writes the outputs. Throws std::runtime_error where those
  /// cannot be written, or where the disk refused the journal's last events to the end.
  void run();

  /// From now on `run` has so much time to end in: half of it at most to handle what was received, the rest
  /// to finish the map and write it. Once; any thread.
  void stop_within(std::chrono::steady_clock::duration time);

  const Estimator& engine() const { return map_.estimator(); }
  /// Of the robots, by the configuration; they stay.
  const ChannelNames& channels() const { return map_.channels; }

  /// Knows the configuration's keys, and what the journal that was found has taken already.
  Authenticator authenticator() const { return Authenticator(authentication_, counters_); }

 private:
  static constexpr double handling_share = 0.5;  ///< of the time to stop in

  void begin();
  void begin_spool();
  void begin_guard();
  void begin_goals();
  RecoveryOptions recovery_options() const;
  void begin_recovery();
  bool has_signed_segments() const;
  void know_robots();
  void recover();
  void tell_journal_found() const;
  void freeze();
  void refuse_strangers();
  void handle(Message message);
  DropReason refusal(const Event& event);
  DropReason take(const Event& event);
  DropReason hand_on(const Message& message, const Decoded& decoded);
  void tell_sender(const Message& message, const Decoded& decoded, DropReason reason) const;
  std::string remark_on(const Decoded& decoded) const;
  bool journal(const Message& message);
  void reserve_queue(const Event& event);
  std::string finish_journal();
  void publish_poses(const Outcome& outcome);
  void show(const RobotPose& pose);
  void tick_if_due();
  void go_on_in_time(std::int64_t journal_utime);
  void tell_clock_step();
  void drop(const std::string& robot, DropReason reason, const Dropped& dropped);
  void count_inbox_drops();
  void record_drops_if_due();
  void publish_status_if_due();
  void keep_snapshots();
  ServerCounters server_counters() const;
  void note_mistakes(const Message& message, DropReason reason);
  void update_warnings(const MapCopy& map, status_t& status);
  bool is_past(double share_of_time) const;
  void count_left_over();
  void end();
  bool finish_map(std::chrono::steady_clock::duration time_to_write);
  void write_results(bool finished);
  void say(LogLevel level, std::string_view message, const LogFields& fields) const;

  LiveOptions options_;
  std::unique_ptr<CrashGuard> guard_;  ///< with a journal
  Inbox& inbox_;
  Publish publish_;
  Answers answers_;
  Authentication authentication_;
  SignatureCounters counters_;
  ServedMap map_;
  Admission admission_;
  RendezvousPublisher rendezvous_;
  LatencyHistogram latency_;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_event_;
  std::chrono::steady_clock::time_point last_status_;
  std::chrono::steady_clock::time_point stop_asked_;  ///< valid once there is a deadline
  std::atomic<std::chrono::steady_clock::time_point> deadline_{std::chrono::steady_clock::time_point::max()};
  ClosureLog closure_log_;
  LiveWarnings warnings_;
  SelfCheck self_check_;
  std::unique_ptr<Journal> journal_;
  std::shared_ptr<Spool> spool_;  ///< with a journal
  std::unique_ptr<Settlement> settlement_;
  std::chrono::steady_clock::time_point drops_recorded_;
  std::unique_ptr<SnapshotProcess> snapshots_;
  std::int64_t clock_steps_ = 0;
  double finish_s_ = 0;
  bool recovered_all_ = true;           ///< of the journal that was found
  int closed_segments_ = 0;             ///< that have been reported
  std::unique_ptr<Recovery> recovery_;  ///< of a journal that was found, until it is done
  std::unique_ptr<MapPublisher> map_publisher_;
  std::unique_ptr<GoalPublisher> goals_;  ///< where robots explore by the server's goals
};

}  // namespace isthmus
