// A server that makes maps of features, killed while it maps and while it recovers.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "server/wire/journal/recovery/snapshots.hpp"
#include "server/wire/message/message.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/waiting.hpp"
#include "tools/replay/feature_replay.hpp"
#include "tools/simulate/run/simulation.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string text_in(const std::string& file) {
  const std::vector<std::uint8_t> bytes = read_bytes(file);
  return {bytes.begin(), bytes.end()};
}

std::size_t times_in(const std::string& text, const std::string& words) {
  std::size_t times = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) ++times;
  return times;
}

/// The four robots of the office, in parts of their drive, each ending with an order that means nothing here.
class OfficeInParts {
 public:
  explicit OfficeInParts(const TemporaryDirectory& directory) : directory_(directory) {
    const SimulatedRun run = simulate(load_scenario("office", {}), 1);
    for (std::size_t part = 0; part < parts; ++part) {
      std::vector<Message> messages;
      for (std::size_t i = part * run.events.size() / parts; i < (part + 1) * run.events.size() / parts; ++i)
        messages.push_back(encode(run.events[i]));
      const std::int64_t utime = messages.back().utime;
      messages.push_back(encode(Event{utime, CommandEvent{utime, Verb::refine, -1, ""}}));
      write_log(log(part), messages);
    }
  }

  static constexpr std::size_t parts = 4;
  std::string log(std::size_t part) const { return directory_ / ("part-" + std::to_string(part) + ".lcm"); }

 private:
  const TemporaryDirectory& directory_;
};

class FeatureServer {
 public:
  explicit FeatureServer(const TemporaryDirectory& directory) : directory_(directory) {}

  pid_t start(const std::string& log) const {
    const std::string url = "file://" + log, journal = this->journal(), output = directory_ / "map",
                      words = directory_ / "server.log";
    const pid_t child = fork();
    if (child != 0) return child;
    const int file = ::open(words.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
    ::dup2(file, STDERR_FILENO);
    ::execl(ISTHMUS_BIN_DIRECTORY "/isthmus-server", "isthmus-server", "--lcm-url", url.c_str(), "--journal",
            journal.c_str(), "--output", output.c_str(), "--force", "--estimator", "segments", "--segment-mb",
            "0.5", static_cast<char*>(nullptr));
    ::_exit(127);
  }

  void kill_when(pid_t server, const std::function<bool()>& due) const {
    EXPECT_TRUE(happens(due, std::chrono::seconds(120))) << words();
    ::kill(server, SIGKILL);
    int status = 0;
    ::waitpid(server, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status)) << "it ended before it was killed\n" << words();
  }

  std::string journal() const { return directory_ / "journal"; }
  std::string words() const { return text_in(directory_ / "server.log"); }
  std::size_t journalled() const { return fs::exists(journal()) ? read_log(journal()).messages.size() : 0; }
  /// Of the segments, not of what waits to be handled.
  std::uintmax_t journalled_bytes() const {
    std::uintmax_t bytes = 0;
    std::error_code error;
    for (fs::directory_iterator entry(journal(), error), end; !error && entry != end; entry.increment(error))
      if (entry->path().extension() == ".lcm") bytes += entry->file_size(error);
    return bytes;
  }
  /// As isthmus-snapshot does beside a server, in its own time.
  void make_snapshots() const {
    SnapshotPolicy policy;
    policy.wait = true;
    update_snapshots(journal(), policy);
  }

 private:
  const TemporaryDirectory& directory_;
};

TEST(FeatureServerScenario, IsKilledMappingAndRecoveringAndEndsWithTheMapOfAReplayOfItsJournal) {
  const TemporaryDirectory directory;
  const OfficeInParts office(directory);
  const FeatureServer server(directory);
  for (std::size_t part = 0; part + 1 < OfficeInParts::parts; ++part) {
    const std::uintmax_t due = server.journalled_bytes() + fs::file_size(office.log(part)) / 2;
    server.kill_when(server.start(office.log(part)), [&] { return server.journalled_bytes() > due; });
    server.make_snapshots();
    const std::size_t recoveries = times_in(server.words(), "recovering the journal");
    const std::size_t kept = server.journalled();
    server.kill_when(server.start(office.log(part)),
                     [&] { return times_in(server.words(), "recovering the journal") > recoveries; });
    EXPECT_GE(server.journalled(), kept) << "no event that was journalled is lost";
  }
  int status = 0;
  ::waitpid(server.start(office.log(OfficeInParts::parts - 1)), &status, 0);
  ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << server.words();

  const Json report = Json::parse(text_in(directory / "map/report.json"));
  FeatureReplayOptions options;
  options.map = feature_map_options(*feature_kind_of(server.journal()));
  const FeatureMaps maps = replay_features(server.journal(), options).maps;
  EXPECT_EQ(report.at("map_sha256"), map_sha256(maps));
  EXPECT_GE(maps.counts.fusions, 1);
  EXPECT_GE(maps.counts.dropped.at("no_manifold"), 1) << "in the part that was heard to its end";
  EXPECT_NE(server.words().find("no_manifold"), std::string::npos) << "the order's sender is told";
  EXPECT_GE(times_in(server.words(), "of_a_snapshot="), 1U);
  EXPECT_EQ(times_in(server.words(), "of_a_snapshot=0"), 0U) << "each recovery begins with a snapshot";
}

}  // namespace
}  // namespace isthmus
