#include "server/wire/live/snapshot_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <utility>
#include <vector>

#include "server/wire/file/file_bytes.hpp"

namespace isthmus {
namespace {

constexpr int lowest_priority = 19;

std::string program_beside_this() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (self.parent_path() / "isthmus-snapshot").string();
}

}  // namespace

SnapshotProcess::SnapshotProcess(std::string journal_directory, int keep_snapshots,
                                 std::optional<int> keep_segments,
                                 std::function<void(const std::string&)> report)
    : journal_directory_(std::move(journal_directory)),
      keep_snapshots_(keep_snapshots),
      keep_segments_(keep_segments),
      report_(std::move(report)) {}

SnapshotProcess::~SnapshotProcess() { poll(); }

void SnapshotProcess::segment_closed() {
  wanted_ = true;
  poll();
}

void SnapshotProcess::poll() {
  int status = 0;
  if (process_ > 0 && ::waitpid(process_, &status, WNOHANG) == process_) {
    process_ = 0;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
      report_("isthmus-snapshot failed on " + journal_directory_ + "; a restart will take longer");
  }
  if (process_ == 0 && wanted_) begin();
}

void SnapshotProcess::begin() {
  wanted_ = false;
  const std::string program = program_beside_this();
  std::vector<std::string> words = {program, journal_directory_, "--keep-snapshots",
                                    std::to_string(keep_snapshots_)};
  if (keep_segments_) words.insert(words.end(), {"--keep-segments", std::to_string(*keep_segments_)});
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  // The server's threads block the signals that stop it; this process shall be stopped by them.
  posix_spawnattr_t attributes;
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  // Not all libraries' sockets are closed by themselves, and a port must be free again once the server ends.
  posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  const int error = posix_spawn(&process_, program.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error != 0) {
    process_ = 0;
    report_(program + ": " + errno_text(error) + "; a restart will take longer");
    return;
  }
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(process_), lowest_priority);
}

}  // namespace isthmus
