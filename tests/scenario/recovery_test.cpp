// A server that is killed again and again while it maps; tools/kill_campaign.py does it some hundred times.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>

#include "tests/support/box_room.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/waiting.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

/// isthmus-server on a log file, with a journal and an output directory.
pid_t start_server(const TemporaryDirectory& directory) {
  const std::string program = ISTHMUS_BIN_DIRECTORY "/isthmus-server";
  const std::string url = "file://" + directory / "run.lcm";
  const std::string journal = directory / "journal";
  const std::string output = directory / "map";
  const std::string errors = directory / "server.log";
  const pid_t child = fork();
  if (child != 0) return child;
  const int file = ::open(errors.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0666);
  ::dup2(file, STDERR_FILENO);
  ::execl(program.c_str(), "isthmus-server", "--lcm-url", url.c_str(), "--journal", journal.c_str(),
          "--output", output.c_str(), static_cast<char*>(nullptr));
  ::_exit(127);
}

/// The exit code; -1 where a signal ended it.
int wait_for(pid_t server) {
  int status = 0;
  ::waitpid(server, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void write_team_log(const std::string& path) {
  const std::vector<BoxRoomRobot> robots = {BoxRoomRobot("R1"), BoxRoomRobot("R2"), BoxRoomRobot("R3")};
  std::vector<Message> messages;
  for (const BoxRoomRobot& robot : robots) messages.push_back(robot.introduction());
  for (int round = 0; round < 1500; ++round) {
    for (const BoxRoomRobot& robot : robots)
      for (const Message& message : robot.round(round)) messages.push_back(message);
  }
  write_log(path, messages);
}

std::int64_t bytes_of(const std::string& journal) {
  std::int64_t bytes = 0;
  std::error_code error;
  for (fs::directory_iterator entry(journal, error), end; !error && entry != end; entry.increment(error))
    bytes += static_cast<std::int64_t>(entry->file_size());
  return bytes;
}

/// How often the server has said a text, in all its lives.
int times_said(const TemporaryDirectory& directory, const std::string& text) {
  if (!fs::exists(directory / "server.log")) return 0;
  const std::string log = content(directory / "server.log");
  int times = 0;
  for (std::size_t at = log.find(text); at != std::string::npos; at = log.find(text, at + 1)) ++times;
  return times;
}

/// A server that is killed once `due` holds; its journal, as the kill left it.
std::vector<Message> killed(const TemporaryDirectory& directory, const std::function<bool()>& due) {
  const pid_t server = start_server(directory);
  EXPECT_TRUE(happens(due, std::chrono::seconds(120))) << content(directory / "server.log");
  ::kill(server, SIGKILL);
  EXPECT_EQ(wait_for(server), -1) << "it ended before it was killed";
  return read_log(directory / "journal").messages;
}

bool begins_with(const std::vector<Message>& whole, const std::vector<Message>& part) {
  return part.size() <= whole.size() && std::equal(part.begin(), part.end(), whole.begin(), same);
}

TEST(KilledServer, KeepsEveryEventOfAllItsLivesAndEndsWithTheMapThatAReplayMakes) {
  const TemporaryDirectory directory;
  const std::string journal = directory / "journal";
  write_team_log(directory / "run.lcm");
  std::vector<Message> kept;
  for (const int life : {0, 1, 2, 3}) {
    const std::int64_t before = bytes_of(journal);
    // Every other time while it recovers, when there is something to recover.
    const bool while_recovering = life % 2 == 1;
    const std::vector<Message> now = killed(directory, [&] {
      return while_recovering ? times_said(directory, "recovering the journal") > life / 2
                              : bytes_of(journal) > before + 300'000;
    });
    EXPECT_TRUE(begins_with(now, kept)) << "life " << life << " lost events of those before";
    if (!while_recovering) {
      EXPECT_GT(now.size(), kept.size() + 300);
    }
    kept = now;
  }
  EXPECT_EQ(wait_for(start_server(directory)), 0) << content(directory / "server.log");
  const LogContent log = read_log(journal);
  EXPECT_TRUE(begins_with(log.messages, kept));
  EXPECT_GE(log.messages.size(), kept.size() + 3U + 3U * 2U * 1500U) << "all of the log in the last life";
  EXPECT_EQ(log.skipped + log.missing, 0);
  EXPECT_NE(content(directory / "map/report.json").find(replay_of(journal).sha256), std::string::npos);
  EXPECT_GE(times_said(directory, "msg=recovered"), 2);
}

}  // namespace
}  // namespace isthmus
