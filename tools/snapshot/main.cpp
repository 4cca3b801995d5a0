#include <CLI/CLI.hpp>
#include <cstdio>

#include "server/program/command_line.hpp"
#include "server/program/values.hpp"
#include "server/wire/journal/recovery/snapshots.hpp"

namespace {

using namespace isthmus;

struct Arguments {
  std::string journal;
  int keep_snapshots = 10;
  int keep_segments = -1;
  bool wait = false;
};

void run(const Arguments& arguments) {
  SnapshotPolicy policy;
  policy.keep_snapshots = arguments.keep_snapshots;
  if (arguments.keep_segments >= 0) policy.keep_segments = arguments.keep_segments;
  policy.wait = arguments.wait;
  policy.warn = [](const std::string& warning) {
    std::fprintf(stderr, "isthmus-snapshot: %s\n", warning.c_str());
  };
  const SnapshotsMade made = update_snapshots(arguments.journal, policy);
  if (made.busy) {
    std::printf("%s: another process is making the snapshots\n", arguments.journal.c_str());
    return;
  }
  std::printf("%s: %d snapshots written, the newest after segment %d; %d segments pruned\n",
              arguments.journal.c_str(), made.written, made.last_segment, made.pruned_segments);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Keeps snapshots of a journal's closed segments, from which a server restarts sooner. The server runs "
      "it "
      "beside itself; by hand it does what is left to do.",
      "isthmus-snapshot");
  Arguments arguments;
  app.add_option("journal", arguments.journal, "a journal's directory")->required();
  app.add_option("--keep-snapshots", arguments.keep_snapshots,
                 "number of snapshots to keep: the newest, and of what was before ever fewer")
      ->check(integer_in(2, 1000))
      ->capture_default_str();
  app.add_option("--keep-segments", arguments.keep_segments,
                 "number of closed segments to keep that snapshots already cover (default: all)")
      ->check(integer_in(0, 1'000'000));
  app.add_flag("--wait", arguments.wait,
               "where another process is making snapshots, wait for it to end and do the rest");
  return run_program(app, argc, argv, [&] { run(arguments); });
}
