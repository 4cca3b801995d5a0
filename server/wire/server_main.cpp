#include <pthread.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <exception>
#include <future>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>

#include "server/output/output.hpp"
#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/values.hpp"
#include "server/wire/file/text_file.hpp"
#include "server/wire/foxglove/foxglove_server.hpp"
#include "server/wire/journal/event_log.hpp"
#include "server/wire/journal/journal_files.hpp"
#include "server/wire/live/answers.hpp"
#include "server/wire/live/lcm_link.hpp"
#include "server/wire/live/live_server.hpp"
#include "server/wire/message/configuration_doubts.hpp"
#include "server/wire/page/http/access.hpp"
#include "server/wire/page/page_server.hpp"
#include "server/wire/watch/http_page.hpp"
#include "server/wire/watch/metrics.hpp"

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
  int http_port = 0;
  int foxglove_port = 0;
  std::string http_address = "127.0.0.1";
  std::string http_token_file;
  double segment_mb = 64;
  bool no_snapshots = false;
  int keep_snapshots = 10;
  int keep_segments = -1;
  bool frozen = false;
  std::optional<EstimatorKind> estimator;
  bool force = false;
  double status_s = 1;
  double map_s = 60;
  double grid_s = 5;
  int stop_timeout_s = 30;
};

/// Of a server that got a second signal to stop.
constexpr int stopped_at_once = 3;

void add_periods(CLI::App& app, Arguments& arguments) {
  const auto add = [&](const char* name, double& seconds, double least, const char* help) {
    app.add_option(name, seconds, help)
        ->type_name("SECONDS")
        ->check(number_in(least, 86'400.0))
        ->capture_default_str();
  };
  add("--status-period", arguments.status_s, 0.1, "of ISTHMUS_STATUS, and of changes on ISTHMUS_MAP");
  add("--map-period", arguments.map_s, 1, "of the whole map, with the grids, for those who come late");
  add("--grid-period", arguments.grid_s, 0.1, "in which the grid of one island that changed is sent");
}

void add_journal_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--journal", arguments.journal_directory,
                 "directory for the record of all events; one that exists is continued");
  app.add_option("--segment-mb", arguments.segment_mb, "size of one file of the journal, such as 0.5")
      ->check(number_in(0.01, 1e6))
      ->capture_default_str();
  app.add_flag("--no-snapshots", arguments.no_snapshots,
               "do not run isthmus-snapshot: a restart then maps the whole journal again");
  app.add_option("--keep-snapshots", arguments.keep_snapshots,
                 "number of snapshots to keep: the newest, and of what was before ever fewer")
      ->check(integer_in(2, 1000))
      ->capture_default_str();
  app.add_option("--keep-segments", arguments.keep_segments,
                 "number of files of the journal to keep that snapshots already cover (default: all)")
      ->check(integer_in(0, 1'000'000));
  app.add_option(
         "--journal-waiting-mb", arguments.journal_waiting_mb,
         "megabytes of events kept in memory while the disk refuses writes; further ones are rejected")
      ->check(integer_in(0, 1'000'000))
      ->capture_default_str();
  app.add_flag("--frozen", arguments.frozen,
               "localise robots in the map of a journal, which is only read: neither changes")
      ->needs("--journal");
}

void add_page_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--metrics-port", arguments.metrics_port,
                 "Prometheus metrics at http://127.0.0.1:PORT/metrics; 0: none")
      ->check(integer_in(0, 65535));
  app.add_option("--http-port", arguments.http_port,
                 "a page to watch and overrule the map at http://127.0.0.1:PORT/; 0: none")
      ->check(integer_in(0, 65535));
  app.add_option("--foxglove-port", arguments.foxglove_port,
                 "a WebSocket to watch the map with Foxglove or Lichtblick at ws://127.0.0.1:PORT; 0: none")
      ->check(integer_in(0, 65535));
  const auto needs_port = [&arguments] {
    if (arguments.http_port == 0 && arguments.foxglove_port == 0)
      throw CLI::RequiresError("--http-bind and --http-token-file", "--http-port or --foxglove-port");
  };
  app.add_option("--http-bind", arguments.http_address,
                 "address that the page and the WebSocket are served at; others than this machine's need a "
                 "token")
      ->capture_default_str();
  app.add_option("--http-token-file", arguments.http_token_file,
                 "file with a token that viewers of the page and the WebSocket must have");
  app.callback([&app, &arguments, needs_port] {
    if (app.count("--http-bind") + app.count("--http-token-file") > 0) needs_port();
    if (!is_loopback(arguments.http_address) && arguments.http_token_file.empty())
      throw CLI::ValidationError("--http-bind " + arguments.http_address,
                                 "what others can reach needs a token (--http-token-file)");
  });
}

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--config", arguments.config_file, "TOML configuration; none is needed");
  app.add_option("--lcm-url", arguments.lcm_url, "LCM network, or file://LOG for a log")
      ->capture_default_str();
  add_journal_options(app, arguments);
  app.add_option("-o,--output", arguments.output_directory,
                 "directory for maps and trajectories, written at the end");
  add_force(app, arguments.force);
  app.add_option_function<std::string>(
         "--estimator",
         [&arguments](const std::string& name) { arguments.estimator = value_of<EstimatorKind>(name); },
         "manifold, or maps of features: segments (walls in scans) or points (fixed barcodes); as estimator "
         "in the configuration")
      ->check(one_of({"manifold", "segments", "points"}));
  add_periods(app, arguments);
  app.add_option(
         "--stop-timeout", arguments.stop_timeout_s,
         "time limit for stopping: results are written at once, and again when the map is finished or "
         "this time is over")
      ->type_name("SECONDS")
      ->check(integer_in(1, 86'400))
      ->capture_default_str();
  add_page_options(app, arguments);
  app.add_option("--check-config", arguments.checked_file,
                 "check this configuration, report errors, and exit");
  app.add_option("--log-level", arguments.log_level, "lowest level that is logged on stderr")
      ->check(one_of({"debug", "info", "warning", "error"}))
      ->capture_default_str();
}

void say(const std::string& text) { std::cerr << ("isthmus-server: " + text + "\n"); }

/// The configuration's text, with warnings of what may be meant otherwise, and of keys that others may read.
std::string read_configuration(const std::string& file) {
  if (file.empty()) return "";
  std::string toml = read_text_file(file);
  const ServerConfiguration configuration = parse_server_configuration(toml, file);
  const std::string warning_of_file = "warning: " + file + ": ";
  for (const std::string& doubt : configuration_doubts(configuration.engine)) say(warning_of_file + doubt);
  const Authentication& keys = configuration.authentication;
  if (keys.withheld) throw std::runtime_error(file + ": a key in [auth] is empty");
  if (!keys.is_required()) return toml;
  if (const std::string warning = check_key_file(file); !warning.empty()) say("warning: " + warning);
  return toml;
}

/// Blocks SIGINT and SIGTERM in this thread and all that it starts, so that only `wait_for` sees them.
sigset_t block_stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  return signals;
}

/// The next signal ends this process at once, whatever it is at.
void end_at_next_signal(const sigset_t& signals) {
  struct sigaction action {};
  action.sa_handler = [](int) { _exit(stopped_at_once); };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

/// Until a signal, what `is_over` says, or the end of the server. The server knows of the signal.
template <class Condition>
void wait_for_end(const sigset_t& signals, const std::future<void>& running, LiveServer& server,
                  std::chrono::seconds stop_timeout, const Log& log, const Condition& is_over) {
  const timespec interval{0, 100'000'000};
  while (sigtimedwait(&signals, nullptr, &interval) < 0)
    if (is_over() || running.wait_for(std::chrono::seconds(0)) == std::future_status::ready) return;
  log(LogLevel::info, "stopping; once more to stop at once",
      {{"seconds_at_most", std::to_string(stop_timeout.count())}});
  server.stop_within(stop_timeout);
  end_at_next_signal(signals);
}

/// The time of a log's first event. Throws std::runtime_error where it is no log.
std::int64_t first_utime(const std::string& log) {
  const std::optional<Message> first = EventLogReader(log).next();
  return first ? first->utime : 0;
}

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<std::int64_t>(1e3 * seconds));
}

/// Whether results may be written, before any work is done for them: those of a journal that goes on may go.
void check_output(const Arguments& arguments, const Log& log) {
  if (arguments.output_directory.empty()) {
    if (arguments.journal_directory.empty())
      log(LogLevel::warning, "nothing of this map will be kept: there is neither --journal nor --output", {});
    return;
  }
  const bool goes_on = is_journal(arguments.journal_directory);
  check_new_directory(arguments.output_directory, arguments.force || goes_on);
}

/// Of a server that receives from the network, or reads `log_file` where there is one.
LiveOptions live_options(const Arguments& arguments, const std::string& toml, const std::string& log_file,
                         const Log& log) {
  LiveOptions options;
  options.toml = arguments.estimator ? with_estimator(toml, *arguments.estimator) : toml;
  options.journal_directory = arguments.journal_directory;
  options.frozen = arguments.frozen;
  options.output_directory = arguments.output_directory;
  options.status_interval = milliseconds(arguments.status_s);
  options.map.whole_map_interval = milliseconds(arguments.map_s);
  options.map.grid_interval = milliseconds(arguments.grid_s);
  options.journal.segment_bytes = static_cast<std::int64_t>(arguments.segment_mb * 1e6);
  options.snapshots = !arguments.no_snapshots;
  options.keep_snapshots = arguments.keep_snapshots;
  if (arguments.keep_segments >= 0) options.keep_segments = arguments.keep_segments;
  options.journal.waiting_bytes = arguments.journal_waiting_mb * 1024 * 1024;
  options.journal.report = [log](const std::string& text) { log(LogLevel::warning, text, {}); };
  options.log = log;
  options.mistakes = std::make_shared<Mistakes>();
  if (log_file.empty()) {
    options.clock = std::make_shared<EventClock>();
  } else {
    options.start_utime = first_utime(log_file);
  }
  return options;
}

/// A log's messages in its order; senders of a network in turn, by the server's clock.
Inbox inbox_of(const LiveOptions& options) {
  if (!options.clock) return Inbox({}, InboxOrder::arrival, {});
  return Inbox({}, InboxOrder::fair, [clock = options.clock] { return clock->now(); });
}

/// What viewers must have; empty where that is nothing.
std::string token_of(const Arguments& arguments) {
  if (arguments.http_token_file.empty()) return "";
  if (const std::string warning = check_key_file(arguments.http_token_file); !warning.empty())
    say("warning: " + warning);
  return read_token(arguments.http_token_file);
}

std::unique_ptr<FoxgloveServer> foxglove_server(const Arguments& arguments, const std::string& token) {
  if (arguments.foxglove_port == 0) return nullptr;
  FoxgloveOptions options;
  options.port = arguments.foxglove_port;
  options.address = arguments.http_address;
  options.token = token;
  return std::make_unique<FoxgloveServer>(options);
}

/// The page, where one is asked for.
std::unique_ptr<PageServer> page_server(const Arguments& arguments, const std::string& token,
                                        bool orders_signed, TakeMessage take) {
  if (arguments.http_port == 0) return nullptr;
  PageOptions options;
  options.port = arguments.http_port;
  options.address = arguments.http_address;
  options.journal_directory = arguments.journal_directory;
  options.orders_signed = orders_signed;
  options.token = token;
  return std::make_unique<PageServer>(options, std::move(take));
}

/// Each may be missing.
Viewers viewers_of(PageServer* page, FoxgloveServer* foxglove, bool frozen) {
  Viewers viewers;
  if (!page && !foxglove) return viewers;
  viewers.pose = [=](const RobotPose& pose) {
    if (page) page->model().show(pose);
    if (foxglove) foxglove->show(pose);
  };
  viewers.map = [=](std::shared_ptr<const MapCopy> map, const status_t& status, double latency_p99_s) {
    if (foxglove) foxglove->show(map, status);
    if (page) page->model().show(LiveView{std::move(map), status, latency_p99_s, frozen});
  };
  if (foxglove) viewers.event = [=](const Event& event) { foxglove->show(event); };
  if (!page) return viewers;
  viewers.goals = [=](TeamGoals team) { page->model().show(std::move(team)); };
  viewers.order = [=](std::int64_t order_utime, DropReason reason, const std::string& remark) {
    page->orders().answered(order_utime, reason, remark);
  };
  return viewers;
}

void log_addresses(const Arguments& arguments, const std::string& url, const PageServer* page,
                   const FoxgloveServer* foxglove, const Log& log) {
  log(LogLevel::info, "listening", {{"url", url}});
  if (page)
    log(LogLevel::info, "page",
        {{"url", "http://" + arguments.http_address + ":" + std::to_string(page->port()) + "/"}});
  if (foxglove)
    log(LogLevel::info, "Foxglove and Lichtblick",
        {{"url", "ws://" + arguments.http_address + ":" + std::to_string(foxglove->port())}});
}

/// Until a signal or the end of the log, and until what was received by then is handled.
void run_to_the_end(LiveServer& server, LcmLink& link, Inbox& inbox, const sigset_t& signals,
                    std::chrono::seconds stop_timeout, bool of_network, const Log& log,
                    std::future<void>& running) {
  wait_for_end(signals, running, server, stop_timeout, log, [&] { return link.ended(); });
  if (of_network) link.stop();  // what was received before is still handled
  inbox.close();
  link.stop();
  if (link.ended()) wait_for_end(signals, running, server, stop_timeout, log, [] { return false; });
  running.get();
}

/// Says what may go wrong with it.
std::string checked_url(const std::string& lcm_url, const Log& log) {
  std::string url = complete_lcm_url(lcm_url);
  for (const std::string& warning : lcm_url_warnings(url, kernel_receive_buffer_bytes()))
    log(LogLevel::warning, warning, {});
  return url;
}

RefusedOrder teller_of_refused(const Publish& publish, const Log& log) {
  return [answers = Answers(publish, log)](const command_t& order, DropReason reason, std::int64_t utime) {
    answers.tell(order, std::nullopt, reason, "", utime);
  };
}

/// Shows replies on the page, and none once it goes out of scope: the page may go before the desk does.
class RepliesOnPage {
 public:
  RepliesOnPage(std::shared_ptr<QuestionDesk> desk, PageServer& page) : desk_(std::move(desk)) {
    desk_->show_to([&page](const reply_t& reply) { page.model().show(reply); });
  }
  ~RepliesOnPage() { desk_->stop(); }
  RepliesOnPage(const RepliesOnPage&) = delete;
  RepliesOnPage& operator=(const RepliesOnPage&) = delete;

 private:
  std::shared_ptr<QuestionDesk> desk_;
};

void serve(const Arguments& arguments, const std::string& toml) {
  const Log log = log_to_stderr(*parse_log_level(arguments.log_level));
  check_output(arguments, log);
  const sigset_t signals = block_stop_signals();
  const std::string url = checked_url(arguments.lcm_url, log);
  LcmLink link(url, log);
  const std::string log_file = log_file_of(url);
  LiveOptions options = live_options(arguments, toml, log_file, log);
  Inbox inbox = inbox_of(options);
  const Publish publish = [&](const auto& channel, const auto& bytes) { link.publish(channel, bytes); };
  if (log_file.empty()) options.questions = std::make_shared<QuestionDesk>(publish);
  options.publish_failures = [&] { return link.publish_failures(); };
  std::optional<HttpPage> metrics;
  if (arguments.metrics_port > 0) {
    metrics.emplace(arguments.metrics_port, "/metrics", metrics_content_type);
    options.metrics = [&](std::string text) { metrics->set(std::move(text)); };
  }
  std::atomic<bool> receiving = false;
  const bool orders_signed = parse_server_configuration(toml, "configuration").authentication.is_required();
  const std::string token = token_of(arguments);
  const auto foxglove = foxglove_server(arguments, token);
  const auto page = page_server(arguments, token, orders_signed, [&](const auto& channel, const auto& bytes) {
    return receiving ? link.take(channel, bytes) : DropReason::stopped;
  });
  options.viewers = viewers_of(page.get(), foxglove.get(), arguments.frozen);
  std::optional<RepliesOnPage> replies;
  if (page && options.questions) replies.emplace(options.questions, *page);
  LiveServer server(options, inbox, publish);

  const ChannelNames channels = server.channels();
  auto running = std::async(std::launch::async, [&] { server.run(); });
  link.receive_into(inbox, channels, server.authenticator(),
                    {teller_of_refused(publish, log), options.mistakes, options.questions});
  receiving = true;
  log_addresses(arguments, url, page.get(), foxglove.get(), log);
  run_to_the_end(server, link, inbox, signals, std::chrono::seconds(arguments.stop_timeout_s),
                 log_file.empty(), log, running);
}

}  // namespace

int main(int argc, char** argv) {
  share_memory_among_threads();
  CLI::App app(
      "Maps for a team of robots over LCM. SIGINT or SIGTERM stops it within --stop-timeout; a second one "
      "ends "
      "it at once, with exit code 3 and the results that are written.",
      "isthmus-server");
  Arguments arguments;
  add_options(app, arguments);
  return run_program(app, argc, argv, [&] {
    const bool only_check = !arguments.checked_file.empty();
    const std::string file = only_check ? arguments.checked_file : arguments.config_file;
    const std::string toml = read_configuration(file);
    if (only_check) {
      std::cout << file + ": right\n";
    } else {
      serve(arguments, toml);
    }
  });
}
