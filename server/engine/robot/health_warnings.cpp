#include "server/engine/robot/health_warnings.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace isthmus {
namespace {

template <class... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 512> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

double share(std::int64_t part, std::int64_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

bool is_off(double ratio, double factor) { return ratio > factor || ratio < 1 / factor; }

/// "1000", "3.28", "0.00102".
std::string rounded(double ratio) { return text(ratio >= 100 ? "%.0f" : "%.3g", ratio); }

/// "millimetres" for a ratio of 1000; empty where no unit is near.
std::string unit_of(double ratio, double near) {
  struct Unit {
    double per_metre;
    const char* name;
  };
  for (const Unit unit : {Unit{1000, "millimetres"}, Unit{100, "centimetres"}, Unit{39.37, "inches"},
                          Unit{3.281, "feet"}, Unit{0.001, "kilometres"}}) {
    if (!is_off(ratio / unit.per_metre, near)) return unit.name;
  }
  return "";
}

/// "90 s", "4 days".
std::string lasting(double time_s) {
  constexpr double minute_s = 60, hour_s = 3600, day_s = 86'400;
  if (time_s < 5 * minute_s) return text("%.0f s", time_s);
  if (time_s < 3 * hour_s) return text("%.0f minutes", time_s / minute_s);
  return time_s < 3 * day_s ? text("%.0f hours", time_s / hour_s) : text("%.0f days", time_s / day_s);
}

/// What was refused of a robot, and why; empty where nothing was.
std::string dropped_text(const std::map<DropReason, std::int64_t>& dropped) {
  std::string why;
  for (const auto& [reason, count] : dropped)
    why += (why.empty() ? "; dropped: " : ", ") + std::string(word(reason)) + " " + std::to_string(count);
  return why;
}

/// Collects the warnings of one robot.
class Judge {
 public:
  Judge(const std::string& robot, const Laser& laser, const HealthFigures& figures,
        const HealthWarningOptions& options)
      : robot_(robot), laser_(laser), f_(figures), o_(options) {}

  std::vector<HealthWarning> judge(const std::map<DropReason, std::int64_t>& dropped) {
    judge_clock();
    if (laser_.range_max_m > 0) {
      const std::string refused = dropped_text(dropped);
      judge_presence(refused);
      judge_scans(refused);
      if (f_.odometry_messages > 0) judge_motion();
    }
    return std::move(warnings_);
  }

 private:
  const char* name() const { return robot_.c_str(); }

  void warn(const std::string& key, const std::string& sentence) { warnings_.push_back({key, sentence}); }

  void judge_clock() {
    if (std::max(f_.odometry_messages, f_.scans) < o_.min_messages || !f_.clock_ahead_s) return;
    const double ahead_s = *f_.clock_ahead_s;
    if (ahead_s > o_.other_clock_s) {
      warn("clock_ahead", text("%s's clock is ahead by %s: its sightings cannot be paired", name(),
                               lasting(ahead_s).c_str()));
    } else if (ahead_s < -o_.other_clock_s) {
      warn("clock_behind", text("%s's clock is behind by %s, or all that it sent came so late: its "
                                "sightings may not be paired",
                                name(), lasting(-ahead_s).c_str()));
    }
  }

  void judge_presence(const std::string& refused) {
    const auto why = [&](const char* suffix) {
      return refused.empty() ? text(": none came on %s_%s, or the channel that is configured", name(), suffix)
                             : refused;
    };
    if (f_.scans == 0 && f_.odometry_messages >= o_.min_messages)
      warn("no_scans",
           text("%s declares a laser and no scan of it was taken%s", name(), why("SCAN").c_str()));
    if (f_.odometry_messages == 0 && f_.scans >= o_.min_messages)
      warn("no_odometry",
           text("%s sends scans and no odometry of it was taken%s", name(), why("ODOMETRY").c_str()));
  }

  void judge_scans(const std::string& refused) {
    if (f_.scans < o_.min_messages) return;
    if (f_.max_beams < o_.min_beams) {
      warn("few_beams", f_.max_beams == 1 ? text("%s's scans have one beam", name())
                                          : text("%s's scans have at most %lld beams", name(),
                                                 static_cast<long long>(f_.max_beams)));
    } else if (f_.scans_without_return == f_.scans) {
      warn("no_returns", text("no scan of %s had a return: wrong range limits, or a dead laser?", name()));
    } else if (share(f_.scans_with_few_returns, f_.scans) > o_.mostly) {
      warn("few_returns", text("%.0f %% of %s's scans have too few returns to be matched",
                               100 * share(f_.scans_with_few_returns, f_.scans), name()));
    } else if (f_.odometry_messages > 0 &&
               share(f_.scans_matched, f_.scans_matched + f_.scans_unmatched) < o_.mostly) {
      warn("few_matches", text("%.0f %% of %s's scans could be matched%s",
                               100 * share(f_.scans_matched, f_.scans_matched + f_.scans_unmatched), name(),
                               refused.c_str()));
    }
  }

  void judge_motion() {
    const bool moved = std::max(f_.way.laser, f_.way.odometry) >= o_.min_way_m;
    const bool turned = std::max(f_.turn.laser, f_.turn.odometry) >= o_.min_turn_rad;
    if (f_.odometry_messages >= o_.min_messages && f_.odometry_way_m < o_.never_moved_m &&
        f_.odometry_turn_rad < o_.common.yaw_rad(o_.never_moved_m)) {
      if (f_.way.laser >= o_.min_way_m || f_.turn.laser >= o_.min_turn_rad ||
          f_.scans_changed >= o_.min_changes)
        warn("odometry_still", text("%s's odometry never moved, while its scans did: %lld of them show other "
                                    "surroundings than those before",
                                    name(), static_cast<long long>(f_.scans_changed)));
      return;
    }
    const bool another_unit = (moved && is_off(f_.way.ratio(), o_.other_unit)) ||
                              (turned && is_off(f_.turn.ratio(), o_.other_unit));
    if (!another_unit && f_.scans_changed_still >= o_.min_changes &&
        share(f_.scans_changed_still, f_.scans_changed) > o_.freezing_share) {
      warn("odometry_freezes", text("%s's odometry stood still for half a second %lld times while its scans "
                                    "changed: does it freeze?",
                                    name(), static_cast<long long>(f_.scans_changed_still)));
      return;
    }
    const std::size_t before = warnings_.size();
    const bool turn_off = turned && judge_turns();
    const bool way_off = moved && judge_way(turn_off);
    if (moved && !way_off && !turn_off) judge_direction();
    if (turned && f_.best_lag_scans != 0 && std::abs(f_.best_lag_scans) >= o_.late_scans &&
        f_.off_at_best_lag < o_.mostly) {
      warn("time_offset",
           text("%s's odometry fits its scans best %d scans %s: are their clocks apart?", name(),
                std::abs(f_.best_lag_scans), f_.best_lag_scans > 0 ? "late" : "early"));
    }
    if (warnings_.size() != before) return;
    if (moved && f_.way.explained() < o_.mostly)
      warn("odometry_unrelated", text("%s's odometry explains %.0f %% of the motion seen by the laser",
                                      name(), 100 * f_.way.explained()));
    if (turned && f_.turn.explained() < o_.mostly)
      warn("turns_unrelated", text("%s's odometry explains %.0f %% of the turns seen by the laser", name(),
                                   100 * f_.turn.explained()));
  }

  // A wrong heading spoils ways too: their scale then says nothing.
  bool judge_way(bool turn_off) {
    const double ratio = f_.way.ratio();
    if (f_.way.laser < o_.still_share * f_.way.odometry && unit_of(ratio, o_.other_scale).empty() &&
        ratio > o_.still_units * o_.other_unit) {
      warn("laser_still",
           text("%s's odometry drove %.0f m while the laser saw %.1f m: the same scan again and "
                "again, or a wrong unit?",
                name(), f_.way.odometry, f_.way.laser));
    } else if (is_off(ratio, o_.other_unit)) {
      const std::string unit = unit_of(ratio, o_.other_scale);
      warn("odometry_unit",
           text("%s's odometry's way is %s times the laser's: %s%s?", name(), rounded(ratio).c_str(),
                unit.empty() ? "a wrong unit" : "is it in ", unit.c_str()));
    } else if (!turn_off && f_.direction_steadiness >= o_.steady && is_off(ratio, o_.other_scale)) {
      warn("odometry_scale", text("%s's odometry's way is %.2f times the laser's", name(), ratio));
    } else {
      return false;
    }
    return true;
  }

  bool judge_turns() {
    const double ratio = f_.turn.ratio();
    if (is_off(ratio, o_.other_unit)) {
      warn("turn_unit", text("%s's odometry turns %.3g times what the laser sees: degrees for radians, or a "
                             "heading that is not one?",
                             name(), ratio));
    } else if (f_.turn_correlation < -o_.mostly) {
      warn("mount_mirrored",
           text("%s's laser turns against its odometry: mounted upside down, or its beams in "
                "the other order?",
                name()));
    } else if (is_off(ratio, o_.other_scale)) {
      warn("turn_scale", text("%s's odometry turns %.2f times what the laser sees", name(), ratio));
    } else {
      return false;
    }
    return true;
  }

  void judge_direction() {
    const double off_rad = std::abs(f_.direction_rad);
    if (f_.direction_steadiness < o_.steady || off_rad < o_.other_direction_rad) return;
    const double degrees = f_.direction_rad * 180 / std::numbers::pi;
    if (off_rad > o_.backwards_rad) {
      warn("mount_backwards",
           text("%s's laser moves at %.0f degrees to its odometry: mounted backwards?", name(), degrees));
    } else {
      warn("mount_turned",
           text("%s's laser moves at %.0f degrees to its odometry: is its declared yaw right?", name(),
                degrees));
    }
  }

  const std::string& robot_;
  const Laser& laser_;
  const HealthFigures& f_;
  const HealthWarningOptions& o_;
  std::vector<HealthWarning> warnings_;
};

}  // namespace

std::vector<HealthWarning> health_warnings(const std::string& robot, const Laser& laser,
                                           const HealthFigures& figures,
                                           const std::map<DropReason, std::int64_t>& dropped,
                                           const HealthWarningOptions& options) {
  return Judge(robot, laser, figures, options).judge(dropped);
}

}  // namespace isthmus
