#include "tools/import/mrclam_files.hpp"

#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <string_view>

#include "tools/text/lines.hpp"
#include "tools/text/numbers.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t largest_utime = std::int64_t{1} << 53;
constexpr double fastest = 100;  // m/s and rad/s: beyond it is damage

/// Rows of a fixed number of words; empty lines and `#` comments are passed over.
class Rows {
 public:
  Rows(const std::string& file, std::string columns) : lines_(file), columns_(std::move(columns)) {
    split_words(columns_, words_);
    count_ = words_.size();
  }

  bool next() {
    while (const auto line = lines_.next()) {
      split_words(*line, words_);
      if (words_.empty() || words_[0][0] == '#') continue;
      if (words_.size() != count_) fail("wrong count of fields: expected '" + columns_ + "'");
      return true;
    }
    return false;
  }

  std::int64_t utime(std::size_t word) const {
    const auto us = parse_seconds_as_us(words_[word]);
    if (!us || *us < 0 || *us > largest_utime) fail(quoted(word) + " is not a time in seconds");
    return *us;
  }

  double number(std::size_t word, double max) const {
    const auto value = parse_double(words_[word]);
    if (!value || !(std::abs(*value) <= max)) fail(quoted(word) + " is not a believable number");
    return *value;
  }

  std::int32_t integer(std::size_t word, std::int32_t min) const {
    const auto value = parse_integer(words_[word]);
    if (!value || *value < min || *value > std::numeric_limits<std::int32_t>::max()) {
      fail(quoted(word) + " is not an integer from " + std::to_string(min) + " on");
    }
    return static_cast<std::int32_t>(*value);
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(lines_.file(), lines_.number(), reason);
  }

 private:
  std::string quoted(std::size_t word) const { return "'" + std::string(words_[word]) + "'"; }

  LineReader lines_;
  std::string columns_;
  std::size_t count_ = 0;
  std::vector<std::string_view> words_;
};

constexpr double farthest_m = 1e5;
constexpr double largest_angle_rad = 1e3;

}  // namespace

std::string find_mrclam_file(const std::string& directory, const std::string& name) {
  for (const char* end : {".dat", ".dat.gz"}) {
    std::string path = (std::filesystem::path(directory) / (name + end)).string();
    if (std::filesystem::exists(path)) return path;
  }
  return "";
}

std::string mrclam_file(const std::string& directory, const std::string& name) {
  std::string path = find_mrclam_file(directory, name);
  if (path.empty()) throw FileError(directory, 0, "no " + name + ".dat and no " + name + ".dat.gz");
  return path;
}

std::vector<int> mrclam_robots(const std::string& directory) {
  std::vector<int> robots;
  for (int subject = 1; subject <= last_mrclam_robot; ++subject) {
    if (!find_mrclam_file(directory, "Robot" + std::to_string(subject) + "_Odometry").empty()) {
      robots.push_back(subject);
    }
  }
  if (robots.empty()) throw FileError(directory, 0, "no RobotN_Odometry.dat: not a MRCLAM set");
  return robots;
}

std::map<int, std::int32_t> read_barcodes(const std::string& file) {
  Rows rows(file, "subject barcode");
  std::map<int, std::int32_t> barcodes;
  std::set<std::int32_t> known;
  while (rows.next()) {
    const std::int32_t subject = rows.integer(0, 1);
    const std::int32_t barcode = rows.integer(1, 0);
    if (!known.insert(barcode).second) rows.fail("barcode " + std::to_string(barcode) + " twice");
    if (!barcodes.emplace(subject, barcode).second) {
      rows.fail("subject " + std::to_string(subject) + " twice");
    }
  }
  return barcodes;
}

std::vector<VelocityLine> read_velocities(const std::string& file) {
  Rows rows(file, "time forward_velocity angular_velocity");
  std::vector<VelocityLine> lines;
  while (rows.next()) lines.push_back({rows.utime(0), rows.number(1, fastest), rows.number(2, fastest)});
  if (lines.empty()) throw FileError(file, 0, "no odometry in it");
  return lines;
}

std::vector<MeasurementLine> read_measurements(const std::string& file) {
  Rows rows(file, "time barcode range bearing");
  std::vector<MeasurementLine> lines;
  while (rows.next()) {
    lines.push_back({rows.utime(0), rows.integer(1, 0), rows.number(2, farthest_m),
                     wrap_angle(rows.number(3, largest_angle_rad))});
    if (lines.back().range_m < 0) rows.fail("a negative range");
  }
  return lines;
}

std::vector<TruthLine> read_robot_truth(const std::string& file) {
  Rows rows(file, "time x y orientation");
  std::vector<TruthLine> lines;
  while (rows.next()) {
    lines.push_back({rows.utime(0),
                     {rows.number(1, farthest_m), rows.number(2, farthest_m),
                      wrap_angle(rows.number(3, largest_angle_rad))}});
  }
  return lines;
}

std::map<int, Eigen::Vector2d> read_landmark_truth(const std::string& file) {
  Rows rows(file, "subject x y x_std_dev y_std_dev");
  std::map<int, Eigen::Vector2d> positions;
  while (rows.next()) {
    const std::int32_t subject = rows.integer(0, 1);
    const Eigen::Vector2d position = {rows.number(1, farthest_m), rows.number(2, farthest_m)};
    if (!positions.emplace(subject, position).second) {
      rows.fail("subject " + std::to_string(subject) + " twice");
    }
  }
  return positions;
}

}  // namespace isthmus
