#include "tools/import/carmen_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "server/wire/message/limits.hpp"
#include "tools/text/numbers.hpp"

namespace isthmus {
namespace {

/// Message types of CARMEN logs that are neither odometry nor the front laser.
constexpr std::array<std::string_view, 36> other_types = {"PARAM",
                                                          "SYNC",
                                                          "TRUEPOS",
                                                          "RLASER",
                                                          "LASER",
                                                          "LASER1",
                                                          "LASER2",
                                                          "LASER3",
                                                          "LASER4",
                                                          "LASER5",
                                                          "RAWLASER1",
                                                          "RAWLASER2",
                                                          "RAWLASER3",
                                                          "RAWLASER4",
                                                          "RAWLASER5",
                                                          "ROBOTLASER2",
                                                          "ROBOTLASER3",
                                                          "ROBOTLASER4",
                                                          "ROBOTLASER5",
                                                          "NMEAGGA",
                                                          "NMEARMC",
                                                          "NMEAHDT",
                                                          "SONAR",
                                                          "BUMPER",
                                                          "IMU",
                                                          "POSITION",
                                                          "MARKER",
                                                          "SCANMARK",
                                                          "POSITIONLASER1",
                                                          "POSITION_LASER",
                                                          "ROBOTVELOCITY",
                                                          "VECTORMOVE",
                                                          "FOLLOWTRAJECTORY",
                                                          "BASEVELOCITY",
                                                          "ARM",
                                                          "PANTILT"};

/// The start of a word, for an error message: bytes that are no text become '?'.
std::string shown(std::string_view word) {
  std::string text(word.substr(0, 40));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text;
}

/// Goes through the words of a line. The first failure is kept and everything after it reads as zero.
class Words {
 public:
  explicit Words(std::string_view line) { split_words(line, words_); }

  std::string_view type() const { return words_.empty() ? std::string_view{} : words_[0]; }
  const std::string& error() const { return error_; }

  double number() {
    const auto value = parse_double(peek());
    if (!value || !std::isfinite(*value)) {
      fail("is not a finite number");
      return 0;
    }
    ++at_;
    return *value;
  }

  /// A count of values that must follow on this line.
  std::size_t length() {
    const auto value = parse_integer(peek());
    if (!value || *value < 0) {
      fail("is not a count");
      return 0;
    }
    if (static_cast<std::uint64_t>(*value) > words_.size()) {
      fail("counts more values than the line has");
      return 0;
    }
    ++at_;
    return static_cast<std::size_t>(*value);
  }

  /// The same of beams: as many as a message may hold.
  std::size_t beams() {
    const std::size_t count = length();
    if (count <= static_cast<std::size_t>(max_beams)) return count;
    --at_;
    fail("counts more beams than the " + std::to_string(max_beams) + " of a message");
    return 0;
  }

  Pose pose() {
    const double x = number();
    const double y = number();
    return {x, y, wrap_angle(number())};
  }

  std::int64_t stamp() {
    const auto value = parse_seconds_as_us(peek());
    if (!value) {
      fail("is not a time in seconds");
      return 0;
    }
    ++at_;
    return *value;
  }

  std::vector<float> ranges(std::size_t count) {
    std::vector<float> values;
    if (!error_.empty()) return values;
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto value = parse_float(peek());
      if (!value) {
        fail("is not a number");
        return {};
      }
      values.push_back(*value);
      ++at_;
    }
    return values;
  }

  void skip(std::size_t count) { at_ += count; }

  /// Whether the line has exactly this many words.
  bool expect(std::size_t count) {
    if (!error_.empty()) return false;
    if (words_.size() == count) return true;
    error_ = "wrong count of fields in " + std::string(type()) + ": " + std::to_string(words_.size()) +
             " instead of " + std::to_string(count);
    return false;
  }

 private:
  std::string_view peek() const { return at_ < words_.size() ? words_[at_] : std::string_view{}; }

  void fail(const std::string& what) {
    if (!error_.empty()) return;
    error_ = at_ < words_.size()
                 ? "field " + std::to_string(at_ + 1) + " of " + std::string(type()) + " " + what + ": '" +
                       shown(peek()) + "'"
                 : "wrong count of fields in " + std::string(type()) + ": the line ends early";
  }

  std::vector<std::string_view> words_;
  std::size_t at_ = 1;
  std::string error_;
};

/// ODOM x y theta tv rv accel ipc_timestamp host logger_timestamp
CarmenLine odometry_line(Words& words) {
  CarmenLine line;
  if (!words.expect(10)) return line;
  line.odom_from_robot = words.pose();
  words.skip(3);
  line.utime = words.stamp();
  return line;
}

/// FLASER n r… x y theta odom_x odom_y odom_theta ipc_timestamp host logger_timestamp
CarmenLine front_laser_line(Words& words) {
  CarmenLine line;
  const std::size_t n = words.beams();
  if (!words.expect(2 + n + 9)) return line;
  CarmenScan laser;
  laser.scan.ranges_m = words.ranges(n);
  words.skip(3);
  line.odom_from_robot = words.pose();
  line.utime = words.stamp();
  laser.scan.utime = line.utime;
  laser.scan.bearing0_rad = -std::numbers::pi / 2;
  const std::size_t steps = n % 2 == 0 ? n : n - 1;
  laser.scan.bearing_step_rad = std::numbers::pi / static_cast<double>(std::max<std::size_t>(steps, 1));
  line.laser = std::move(laser);
  return line;
}

/// ROBOTLASER1 type start_angle fov resolution max_range accuracy remission_mode n r… m rem… laser_x laser_y
/// laser_theta robot_x robot_y robot_theta tv rv fwd side turn ipc_timestamp host logger_timestamp
CarmenLine robot_laser_line(Words& words) {
  CarmenLine line;
  CarmenScan laser;
  words.skip(1);
  laser.scan.bearing0_rad = words.number();
  const double field_of_view_rad = words.number();
  laser.scan.bearing_step_rad = words.number();
  const double range_max_m = words.number();
  words.skip(2);
  const std::size_t n = words.beams();
  laser.scan.ranges_m = words.ranges(n);
  const std::size_t remissions = words.length();
  words.skip(remissions);
  if (!words.expect(9 + n + 1 + remissions + 14)) return line;
  const Pose odom_from_laser = words.pose();
  line.odom_from_robot = words.pose();
  words.skip(5);
  line.utime = words.stamp();
  laser.scan.utime = line.utime;
  if (laser.scan.bearing_step_rad == 0 && n > 1) {
    laser.scan.bearing_step_rad = field_of_view_rad / static_cast<double>(n - 1);
  }
  laser.robot_from_laser = ominus(odom_from_laser, line.odom_from_robot);
  if (range_max_m > 0) laser.range_max_m = range_max_m;
  line.laser = std::move(laser);
  return line;
}

}  // namespace

ParsedCarmenLine parse_carmen_line(std::string_view text) {
  Words words(text);
  const std::string_view type = words.type();
  if (type.empty() || type[0] == '#') return CarmenOther{};
  CarmenLine line;
  if (type == "ODOM") {
    line = odometry_line(words);
  } else if (type == "FLASER") {
    line = front_laser_line(words);
  } else if (type == "ROBOTLASER1") {
    line = robot_laser_line(words);
  } else if (std::find(other_types.begin(), other_types.end(), type) != other_types.end()) {
    return CarmenOther{};
  } else {
    return "unknown message type '" + shown(type) + "'";
  }
  if (!words.error().empty()) return words.error();
  return line;
}

}  // namespace isthmus
