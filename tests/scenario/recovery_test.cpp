// A server that is killed again and again while it maps; tools/kill_campaign.py does it some hundred times.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/support/box_room.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

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

std::string content(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(KilledServer, EndsWithTheMapThatAReplayOfItsJournalMakes) {
  const TemporaryDirectory directory;
  write_team_log(directory / "run.lcm");
  for (const int milliseconds : {150, 40, 300}) {
    const pid_t server = start_server(directory);
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    ::kill(server, SIGKILL);
    wait_for(server);
  }
  EXPECT_EQ(wait_for(start_server(directory)), 0) << content(directory / "server.log");
  const Replayed replayed = replay(directory / "journal");
  EXPECT_GE(replayed.events, 1U + 3U + 3U * 2U * 1500U);
  EXPECT_NE(content(directory / "map/report.json").find(replayed.sha256), std::string::npos);
  EXPECT_NE(content(directory / "server.log").find("msg=recovered"), std::string::npos);
}

}  // namespace
}  // namespace isthmus
