#include <pthread.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <exception>
#include <fstream>
#include <future>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include "server/output/output.hpp"
#include "server/wire/event_log.hpp"
#include "server/wire/lcm_link.hpp"
#include "server/wire/live_server.hpp"
#include "server/wire/metrics.hpp"

namespace {

using namespace isthmus;

struct Arguments {
  std::string config_file;
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string journal_directory;
  std::int64_t journal_waiting_mb = 64;
  std::string output_directory;
  std::string checked_file;
  std::string log_level = "info";
  int metrics_port = 0;
  std::int64_t segment_mb = 64;
  bool no_snapshots = false;
  int keep_segments = -1;
  bool frozen = false;
};

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--config", arguments.config_file, "TOML configuration; none is needed");
  app.add_option("--lcm-url", arguments.lcm_url, "LCM network, or file://LOG for a log")
      ->capture_default_str();
  app.add_option("--journal", arguments.journal_directory,
                 "directory for the record of all events; what it holds already is mapped again first");
  app.add_option("--segment-mb", arguments.segment_mb,
                 "size of the journal's files, after which the next begins")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_flag("--no-snapshots", arguments.no_snapshots,
               "do not run isthmus-snapshot beside this program: a restart maps the whole journal again");
  app.add_option("--keep-segments", arguments.keep_segments,
                 "how many files of the journal stay that a snapshot holds too; without it all do")
      ->check(CLI::Range(0, 1'000'000));
  app.add_option("--journal-waiting-mb", arguments.journal_waiting_mb,
                 "so much of what a full disk refuses waits in memory; what comes beyond is refused")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_flag("--frozen", arguments.frozen,
               "localise robots in the map of a journal, which is only read: neither changes")
      ->needs("--journal");
  app.add_option("--output", arguments.output_directory,
                 "directory for maps and trajectories, written at the end");
  app.add_option("--metrics-port", arguments.metrics_port,
                 "Prometheus metrics at http://127.0.0.1:PORT/metrics; 0: none")
      ->check(CLI::Range(0, 65535));
  app.add_option("--check-config", arguments.checked_file, "only say whether this configuration is right");
  app.add_option("--log-level", arguments.log_level, "least level of what is logged on stderr")
      ->check(CLI::IsMember({"debug", "info", "warning", "error"}))
      ->capture_default_str();
}

std::string read_text(const std::string& path) {
  if (path.empty()) return "";
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || (file.peek() != EOF && !(text << file.rdbuf())))
    throw std::runtime_error(path + ": cannot be read");
  return text.str();
}

void say(const std::string& text) { std::cerr << ("isthmus-server: " + text + "\n"); }

/// Blocks SIGINT and SIGTERM in this thread and all that it starts, so that only `wait_for` sees them.
sigset_t block_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

/// Until a signal, the end of the file that is read, or the failure of the server.
void wait_for_end(const sigset_t& signals, const LcmLink& link, const std::future<void>& server,
                  const Log& log) {
  const timespec interval{0, 100'000'000};
  while (sigtimedwait(&signals, nullptr, &interval) < 0) {
    if (link.ended() || server.wait_for(std::chrono::seconds(0)) == std::future_status::ready) return;
  }
  log(LogLevel::info, "stopping; once more to stop without results", {});
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

std::int64_t wall_clock_utime() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

/// The time of a log's first event. Throws std::runtime_error where it is no log.
std::int64_t first_utime(const std::string& log) {
  const std::optional<Message> first = EventLogReader(log).next();
  return first ? first->utime : 0;
}

void serve(const Arguments& arguments, const std::string& toml) {
  const Log log = log_to_stderr(*parse_log_level(arguments.log_level));
  const sigset_t signals = block_stop_signals();
  const std::string url = complete_lcm_url(arguments.lcm_url);
  for (const std::string& warning : lcm_url_warnings(url, kernel_receive_buffer_bytes()))
    log(LogLevel::warning, warning, {});
  LcmLink link(url, log);
  const std::string log_file = log_file_of(url);
  Inbox inbox({}, log_file.empty() ? InboxOrder::fair : InboxOrder::arrival);

  LiveOptions options;
  options.toml = toml;
  options.journal_directory = arguments.journal_directory;
  options.frozen = arguments.frozen;
  options.output_directory = arguments.output_directory;
  if (log_file.empty()) {
    options.clock = wall_clock_utime;
  } else {
    options.start_utime = first_utime(log_file);
  }
  options.journal.segment_bytes = arguments.segment_mb * 1'000'000;
  options.snapshots = !arguments.no_snapshots;
  if (arguments.keep_segments >= 0) options.keep_segments = arguments.keep_segments;
  options.journal.waiting_bytes = arguments.journal_waiting_mb * 1024 * 1024;
  options.journal.report = [&](const std::string& text) { log(LogLevel::warning, text, {}); };
  options.log = log;
  options.publish_failures = [&] { return link.publish_failures(); };
  std::optional<MetricsServer> metrics;
  if (arguments.metrics_port > 0) {
    metrics.emplace(arguments.metrics_port);
    options.metrics = [&](std::string text) { metrics->set(std::move(text)); };
  }
  LiveServer server(options, inbox,
                    [&](const auto& channel, const auto& bytes) { link.publish(channel, bytes); });

  const Configuration configuration = server.engine().configuration();
  auto running = std::async(std::launch::async, [&] { server.run(); });
  link.receive_into(inbox, configuration, server.authenticator());
  log(LogLevel::info, "listening", {{"url", url}});
  wait_for_end(signals, link, running, log);
  if (log_file.empty()) link.stop();  // what was received before is still handled
  inbox.close();
  link.stop();
  running.get();
}

}  // namespace

int main(int argc, char** argv) {
  share_memory_among_threads();
  CLI::App app("Maps for a team of robots over LCM. Stop it with SIGINT or SIGTERM.");
  Arguments arguments;
  add_options(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    const bool only_check = !arguments.checked_file.empty();
    const std::string file = only_check ? arguments.checked_file : arguments.config_file;
    const std::string toml = read_text(file);
    const auto parsed = parse_configuration(toml, file);
    if (const std::string* error = std::get_if<std::string>(&parsed)) throw std::runtime_error(*error);
    if (std::get<Configuration>(parsed).authentication.withheld)
      throw std::runtime_error(file + ": a key in [auth] is empty");
    if (only_check) {
      std::cout << file + ": right\n";
    } else {
      serve(arguments, toml);
    }
  } catch (const std::exception& error) {
    say(error.what());
    return 1;
  }
  return 0;
}
