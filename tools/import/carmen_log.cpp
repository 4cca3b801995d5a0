#include "tools/import/carmen_log.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

constexpr double no_return_share = 0.001;

/// Finds the value that a laser reports where nothing came back.
class NoReturnValue {
 public:
  void add(const std::vector<float>& ranges_m) {
    beams_ += static_cast<std::int64_t>(ranges_m.size());
    for (const float range : ranges_m) {
      if (!std::isfinite(range) || range < largest_) continue;
      if (range > largest_) count_ = 0;
      largest_ = range;
      ++count_;
    }
  }

  std::optional<double> value() const {
    if (count_ == 0 || static_cast<double>(count_) < no_return_share * static_cast<double>(beams_)) return {};
    return static_cast<double>(largest_);
  }

 private:
  std::int64_t beams_ = 0;
  std::int64_t count_ = 0;
  float largest_ = 0;
};

std::optional<double> lesser(const std::optional<double>& a, const std::optional<double>& b) {
  if (!a || !b) return a ? a : b;
  return std::min(*a, *b);
}

}  // namespace

CarmenReader::CarmenReader(const std::string& file, bool skip_bad_lines)
    : lines_(file), skip_bad_lines_(skip_bad_lines) {}

std::optional<CarmenLine> CarmenReader::next() {
  try {
    while (const auto text = lines_.next()) {
      ParsedCarmenLine parsed = parse_carmen_line(*text);
      if (CarmenLine* line = std::get_if<CarmenLine>(&parsed)) return std::move(*line);
      const std::string* reason = std::get_if<std::string>(&parsed);
      if (reason == nullptr) continue;
      if (!skip_bad_lines_) throw FileError(lines_.file(), lines_.number(), *reason);
      ++bad_lines_;
    }
  } catch (const TruncatedFile&) {
    if (!skip_bad_lines_) throw;
    ++bad_lines_;
  }
  return std::nullopt;
}

CarmenFacts survey_carmen_log(const std::string& file, bool skip_bad_lines) {
  CarmenReader reader(file, skip_bad_lines);
  CarmenFacts facts;
  NoReturnValue no_return;
  while (const auto line = reader.next()) {
    if (facts.odometry_lines + facts.scans == 0) facts.first_utime = line->utime;
    if (!line->laser) {
      ++facts.odometry_lines;
      continue;
    }
    ++facts.scans;
    no_return.add(line->laser->scan.ranges_m);
    if (!facts.robot_from_laser) facts.robot_from_laser = line->laser->robot_from_laser;
    facts.range_max_m = lesser(facts.range_max_m, line->laser->range_max_m);
  }
  facts.bad_lines = reader.bad_lines();
  facts.range_max_m = lesser(facts.range_max_m, no_return.value());
  if (facts.odometry_lines + facts.scans == 0) {
    throw FileError(file, 0, "no odometry and no laser line: not a CARMEN log");
  }
  return facts;
}

}  // namespace isthmus
