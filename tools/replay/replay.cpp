#include "tools/replay/replay.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <stdexcept>

#include "server/engine/record/refinement.hpp"
#include "server/wire/file/text_file.hpp"
#include "server/wire/journal/drop_record.hpp"
#include "server/wire/journal/event_log.hpp"
#include "server/wire/journal/journal_view.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

double now_s(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Of all threads.
double cpu_now_s() { return now_s(CLOCK_PROCESS_CPUTIME_ID); }

/// One run of the engine over one log.
class Replay {
 public:
  Replay(const std::string& path, const ReplayOptions& options)
      : options_(options),
        path_(whole_log(path)),
        reader_(path),
        own_configuration_(options.config_file.empty()) {
    if (own_configuration_) return;
    ServerConfiguration given =
        parse_server_configuration(read_text_file(options.config_file), options.config_file);
    channels_ = std::move(given.channels);
    result_.engine = Engine(std::move(given.engine));
  }

  ReplayResult run() {
    const Clock::time_point start = Clock::now();
    const double cpu_start_s = cpu_now_s();
    read();
    begin(0);
    const Clock::time_point finish = Clock::now();
    if (options_.refine) command(Verb::refine);
    finish_map(result_.engine, options_);
    if (options_.refine) refine();
    result_.cost.finish_s = seconds_of(Clock::now() - finish);
    result_.cost.wall_s = seconds_of(Clock::now() - start);
    result_.cost.cpu_s = cpu_now_s() - cpu_start_s;
    result_.cost.peak_rss_mb = process_peak_rss_mb();
    return std::move(result_);
  }

 private:
  void read() {
    while (const std::optional<Message> message = reader_.next()) {
      report_damage();
      if (first_utime_ && seconds_after_first(*message) > options_.until_s) return;
      take(*message);
      sample_if_due();
      if (options_.progress) options_.progress(reader_.progress());
    }
    report_damage();
  }

  void sample_if_due() {
    if (!options_.sample || !first_utime_) return;
    const double event_s = 1e-6 * static_cast<double>(last_receive_utime_ - *first_utime_);
    if (event_s < next_sample_s_) return;
    options_.sample(result_.engine, event_s);
    next_sample_s_ = event_s + options_.sample_every_s;
  }

  double seconds_after_first(const Message& message) const {
    return 1e-6 * (static_cast<double>(message.utime) - static_cast<double>(*first_utime_));
  }

  void take(const Message& message) {
    ++result_.messages;
    if (const std::optional<Drops> drops = read_drops(message)) return count_drops(result_.engine, *drops);
    const Decoded decoded = decode(channels_, message.channel, message.bytes, message.utime);
    if (!decoded.ours) {
      ++result_.ignored;
    } else if (!decoded.event) {
      result_.engine.count_dropped(decoded.robot, decoded.reason);
    } else if (const auto* configuration = std::get_if<ConfigurationEvent>(&decoded.event->body)) {
      configure(*configuration, *decoded.event);
    } else {
      begin(decoded.event->receive_utime);
      handle(*decoded.event);
    }
  }

  /// The log's own configuration: only before every other event, and not where another was given.
  void configure(const ConfigurationEvent& configuration, const Event& event) {
    if (!own_configuration_) return;
    const std::string where = reader_.file() + ": configuration at event " +
                              std::to_string(reader_.event_number()) + ", offset " +
                              std::to_string(reader_.offset());
    parse_server_configuration(configuration.toml, where);
    handle(event);
    channels_ = channels_of(result_.engine.configuration());
  }

  /// Before the first event: what must not happen.
  void begin(std::int64_t receive_utime) {
    if (begun_) return;
    begun_ = true;
    last_receive_utime_ = receive_utime;
    for (const ClosureId closure : options_.forbid) command(Verb::forbid, closure.value);
  }

  void command(Verb verb, std::int64_t closure = -1) {
    CommandEvent command;
    command.verb = verb;
    command.closure = closure;
    result_.engine.handle({last_receive_utime_, command});
  }

  /// Reads the log once more, as far as it was read.
  void refine() {
    Refinement refinement(result_.engine.copy(), result_.engine.configuration());
    EventLogReader reader(path_);
    for (std::int64_t i = 0; i < result_.messages; ++i) {
      const std::optional<Message> message = reader.next();
      if (!message) break;
      const Decoded decoded = decode(channels_, message->channel, message->bytes, message->utime);
      if (decoded.event) refinement.take(*decoded.event);
      if (options_.progress) options_.progress(reader.progress());
    }
    result_.refined = refinement.finish();
    result_.scans_refined = refinement.refined();
  }

  void handle(const Event& event) {
    if (!first_utime_) first_utime_ = event.receive_utime;
    last_receive_utime_ = std::max(last_receive_utime_, event.receive_utime);
    const double cpu_s = timed([&] { result_.engine.handle(event); });
    since_scan_s_ += cpu_s;
    if (!std::holds_alternative<ScanEvent>(event.body)) return;
    result_.scan_cost.add(since_scan_s_);
    since_scan_s_ = 0;
  }

  /// Adds the wall and CPU time of `work` to the latencies; returns the CPU time of all threads.
  template <class Work>
  double timed(const Work& work) {
    const double cpu_start_s = cpu_now_s();
    const double thread_start_s = now_s(CLOCK_THREAD_CPUTIME_ID);
    const Clock::time_point start = Clock::now();
    work();
    result_.cost.event_latency.add(seconds_of(Clock::now() - start));
    result_.event_cpu.add(now_s(CLOCK_THREAD_CPUTIME_ID) - thread_start_s);
    return cpu_now_s() - cpu_start_s;
  }

  void report_damage() {
    result_.skipped_bytes = reader_.skipped_bytes();
    result_.missing_events = reader_.missing_events();
    for (const std::string& warning : reader_.take_warnings())
      if (options_.warn) options_.warn(warning);
  }

  const ReplayOptions& options_;
  const std::string& path_;
  EventLogReader reader_;
  bool own_configuration_;
  ChannelNames channels_;
  bool begun_ = false;
  std::optional<std::int64_t> first_utime_;  ///< of the first event
  std::int64_t last_receive_utime_ = 0;
  double since_scan_s_ = 0;
  double next_sample_s_ = 0;
  ReplayResult result_;
};

}  // namespace

const std::string& whole_log(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_directory(path, error)) return path;
  const JournalView journal = view_journal(path);
  require_beginning(journal);
  if (!journal.segments.empty() && journal.segments.front().number != 1) {
    throw std::runtime_error(
        path +
        ": its first segments were pruned; isthmus-export and isthmus-inspect read it by "
        "its snapshots");
  }
  return path;
}

MapCopy ReplayResult::map() const {
  MapCopy map = engine.copy();
  if (refined) map.trajectory = refined;
  return map;
}

void finish_map(Engine& engine, const ReplayOptions& options) {
  Outcome outcome;
  std::int64_t pieces = 0;
  do {
    if (options.finishing)
      options.finishing("finishing: " + std::string(engine.finishing()) + ", " + std::to_string(pieces) +
                        " pieces of work done");
    ++pieces;
  } while (engine.finish_step(outcome));
}

ReplayResult replay(const std::string& path, const ReplayOptions& options) {
  return Replay(path, options).run();
}

}  // namespace isthmus
