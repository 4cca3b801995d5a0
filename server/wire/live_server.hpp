#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/engine/engine.hpp"
#include "server/output/latency.hpp"
#include "server/wire/admission.hpp"
#include "server/wire/authenticator.hpp"
#include "server/wire/closure_log.hpp"
#include "server/wire/inbox.hpp"
#include "server/wire/journal.hpp"
#include "server/wire/log_line.hpp"
#include "server/wire/map_publisher.hpp"
#include "server/wire/recovery.hpp"
#include "server/wire/rendezvous_publisher.hpp"
#include "server/wire/snapshot_process.hpp"

namespace isthmus {

struct LiveOptions {
  std::string toml;               ///< the configuration's text; must parse; empty: that of a found journal
  std::string journal_directory;  ///< empty: no journal; one that holds a journal: it goes on
  bool frozen = false;            ///< the journal is only read: robots are localised in its map
  std::string output_directory;   ///< empty: nothing is exported
  /// The time of ticks, microseconds; none where the messages carry the time of a log.
  std::function<std::int64_t()> clock;
  std::int64_t start_utime = 0;  ///< receive time of the configuration where there is no clock
  std::chrono::milliseconds tick_interval{100};
  std::chrono::milliseconds status_interval{1000};
  MapPublisherOptions map;
  JournalOptions journal;
  bool snapshots = false;            ///< isthmus-snapshot is run beside the server, at each closed segment
  std::optional<int> keep_segments;  ///< see SnapshotPolicy
  AdmissionLimits admission;
  Log log;
  /// Messages that the network refused so far, for the status; empty: none.
  std::function<std::int64_t()> publish_failures;
  /// Takes the metrics with each status; empty: nobody does.
  std::function<void(std::string metrics)> metrics;
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

  /// Leads the engine to where the journal that was found ends; then handles what arrives, until the inbox is
  /// closed and empty; then finishes the map and writes the outputs. Throws std::runtime_error where those
  /// cannot be written, or where the disk refused the journal's last events to the end.
  void run();

  const Engine& engine() const { return map_.engine; }

  /// Knows the configuration's keys, and what the journal that was found has taken already.
  Authenticator authenticator() const { return Authenticator(authentication_, counters_); }

 private:
  void begin();
  RecoveryOptions recovery_options() const;
  void begin_recovery();
  void know_robots();
  void recover();
  void tell_journal_found() const;
  void freeze();
  void handle(Message message);
  void take(const Event& event);
  bool journal(const Message& message);
  void reserve_queue(const Event& event);
  std::string finish_journal();
  void publish_poses(const Outcome& outcome);
  void tick_if_due();
  void count_inbox_drops();
  void publish_status_if_due();
  void keep_snapshots();
  ServerCounters server_counters() const;
  void write_results();
  void say(LogLevel level, std::string_view message, const LogFields& fields) const;

  LiveOptions options_;
  Inbox& inbox_;
  Publish publish_;
  Authentication authentication_;
  SignatureCounters counters_;
  ServedMap map_;
  Admission admission_;
  RendezvousPublisher rendezvous_;
  LatencyHistogram latency_;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_event_;
  std::chrono::steady_clock::time_point last_status_;
  ClosureLog closure_log_;
  std::unique_ptr<Journal> journal_;
  std::unique_ptr<SnapshotProcess> snapshots_;
  int closed_segments_ = 0;             ///< that it has been told of
  std::unique_ptr<Recovery> recovery_;  ///< of a journal that was found, until it is done
  std::unique_ptr<MapPublisher> map_publisher_;
};

}  // namespace isthmus
