#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <map>

#include "tests/support/temporary_directory.hpp"
#include "tools/import/carmen_line.hpp"
#include "tools/import/import.hpp"
#include "tools/text/numbers.hpp"

namespace isthmus {
namespace {

std::string as_seconds(std::int64_t utime) {
  const std::string decimals = std::to_string(1'000'000 + utime % 1'000'000).substr(1);
  return std::to_string(utime / 1'000'000) + "." + decimals;
}

TEST(ImportProperty, StampsSurviveTextExactly) {
  EXPECT_TRUE(rc::check([] {
    const auto utime = *rc::gen::inRange<std::int64_t>(0, 4'000'000'000'000'000);
    RC_ASSERT(parse_seconds_as_us(as_seconds(utime)) == utime);
  }));
}

TEST(ImportProperty, ABrokenLineIsAnErrorOrALineButNeverACrash) {
  const std::vector<std::string> lines = {"ODOM 1.5 -2 0.25 0.1 0.2 0 976052857.337284 host 12.5",
                                          "FLASER 3 1 2 3 9 9 9 1 2 0.5 10.000001 host 77.7",
                                          "ROBOTLASER1 0 -1.5 3 0.01 30 0.01 0 3 1 2 inf 2 7 8 1.2 2.3 0.6 1 "
                                          "2 0.5 0.1 0.2 0.3 0.3 0.4 5.25 host 5.3"};
  EXPECT_TRUE(rc::check([&] {
    std::string line = *rc::gen::elementOf(lines);
    const auto changes = *rc::gen::container<std::vector<std::pair<unsigned, char>>>(
        rc::gen::pair(rc::gen::arbitrary<unsigned>(), rc::gen::arbitrary<char>()));
    for (const auto& [at, c] : changes) line[at % line.size()] = c;
    const ParsedCarmenLine parsed = parse_carmen_line(line);
    if (const auto* whole = std::get_if<CarmenLine>(&parsed)) RC_ASSERT(is_finite(whole->odom_from_robot));
    if (const auto* error = std::get_if<std::string>(&parsed)) RC_ASSERT(!error->empty());
  }));
}

/// What a robot's file says, in order: stamp, and whether the line has a scan.
using FileLines = std::vector<std::pair<std::int64_t, bool>>;

FileLines random_file() {
  const auto stamp = rc::gen::inRange<std::int64_t>(0, 3'000'000);
  return *rc::gen::nonEmpty(rc::gen::container<FileLines>(rc::gen::pair(stamp, rc::gen::arbitrary<bool>())));
}

std::string carmen(const FileLines& lines) {
  std::string text;
  for (const auto& [utime, has_scan] : lines) {
    text += has_scan ? "FLASER 2 1 2 0 0 0 0 0 0 " : "ODOM 0 0 0 0 0 0 ";
    text += as_seconds(utime) + " host 0\n";
  }
  return text;
}

TEST(ImportProperty, MergingKeepsEachFilesOrderAndReceiveTimesNeverFall) {
  const TemporaryDirectory directory;
  EXPECT_TRUE(rc::check([&] {
    std::map<std::string, FileLines> files;
    CarmenImport what;
    for (const std::string robot : {"A", "B", "C"}) {
      files[robot] = random_file();
      what.logs.push_back({robot, directory.write(robot + ".clf", carmen(files[robot]))});
    }
    std::map<std::string, FileLines> read;
    std::map<std::string, std::int64_t> running_maximum;
    std::int64_t last = 0;
    for (const Event& event : import_carmen(what)) {
      if (const auto* odometry = std::get_if<OdometryEvent>(&event.body)) {
        read[odometry->robot].emplace_back(odometry->utime, false);
        auto& highest = running_maximum.emplace(odometry->robot, 0).first->second;
        highest = std::max(highest, odometry->utime);
        RC_ASSERT(event.receive_utime == highest);
        RC_ASSERT(event.receive_utime >= last);
        last = event.receive_utime;
      } else if (const auto* scan = std::get_if<ScanEvent>(&event.body)) {
        RC_ASSERT(read[scan->robot].back() == std::pair(scan->scan.utime, false));
        RC_ASSERT(event.receive_utime == last);
        read[scan->robot].back().second = true;
      }
    }
    RC_ASSERT(read == files);
  }));
}

}  // namespace
}  // namespace isthmus
