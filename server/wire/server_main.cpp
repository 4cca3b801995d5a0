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

#include "server/wire/event_log.hpp"
#include "server/wire/lcm_link.hpp"
#include "server/wire/live_server.hpp"

namespace {

using namespace isthmus;

struct Arguments {
  std::string config_file;
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string journal_directory;
  std::string output_directory;
  bool check_config = false;
};

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--config", arguments.config_file, "TOML configuration; none is needed");
  app.add_option("--lcm-url", arguments.lcm_url, "LCM network, or file://LOG for a log")
      ->capture_default_str();
  app.add_option("--journal", arguments.journal_directory, "new directory for the record of all events");
  app.add_option("--output", arguments.output_directory,
                 "directory for maps and trajectories, written at the end");
  app.add_flag("--check-config", arguments.check_config, "only say whether the configuration is right");
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
void wait_for_end(const sigset_t& signals, const LcmLink& link, const std::future<void>& server) {
  const timespec interval{0, 100'000'000};
  while (sigtimedwait(&signals, nullptr, &interval) < 0) {
    if (link.ended() || server.wait_for(std::chrono::seconds(0)) == std::future_status::ready) return;
  }
  say("stopping; once more to stop without results");
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

void serve(const Arguments& arguments, const std::string& toml, const Configuration& configuration) {
  const sigset_t signals = block_stop_signals();
  const std::string url = complete_lcm_url(arguments.lcm_url);
  for (const std::string& warning : lcm_url_warnings(url, kernel_receive_buffer_bytes())) say(warning);
  LcmLink link(url);
  Inbox inbox;

  LiveOptions options;
  options.toml = toml;
  options.journal_directory = arguments.journal_directory;
  options.output_directory = arguments.output_directory;
  if (const std::string log = log_file_of(url); log.empty()) {
    options.clock = wall_clock_utime;
  } else {
    options.start_utime = first_utime(log);
  }
  options.journal.report = say;
  LiveServer server(options, inbox,
                    [&](const auto& channel, const auto& bytes) { link.publish(channel, bytes); });

  auto running = std::async(std::launch::async, [&] { server.run(); });
  link.receive_into(inbox, configuration);
  say("listening on " + url);
  wait_for_end(signals, link, running);
  if (log_file_of(url).empty()) link.stop();  // what was received before is still handled
  inbox.close();
  link.stop();
  running.get();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Maps for a team of robots over LCM. Stop it with SIGINT or SIGTERM.");
  Arguments arguments;
  add_options(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    const std::string toml = read_text(arguments.config_file);
    const auto parsed = parse_configuration(toml, arguments.config_file);
    if (const std::string* error = std::get_if<std::string>(&parsed)) throw std::runtime_error(*error);
    if (!arguments.check_config) serve(arguments, toml, std::get<Configuration>(parsed));
  } catch (const std::exception& error) {
    say(error.what());
    return 1;
  }
  return 0;
}
