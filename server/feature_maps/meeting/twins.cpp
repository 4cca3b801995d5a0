#include "server/feature_maps/meeting/twins.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace isthmus {
namespace {

/// Spread evenly over headings and a disc, without a random number: multiples of the golden ratio and of a
/// like one, to the power of -1 and -2 (Roberts' sequence).
Pose decoy(std::size_t k, double reach_m) {
  constexpr double by_1 = 0.7548776662466927, by_2 = 0.5698402909980532, golden = std::numbers::phi - 1;
  const double n = static_cast<double>(k + 1);
  const auto fraction = [](double value) { return value - std::floor(value); };
  const double radius = reach_m * std::sqrt(fraction(n * by_1));
  const double angle = 2 * std::numbers::pi * fraction(n * by_2);
  return {radius * std::cos(angle), radius * std::sin(angle),
          wrap_angle(2 * std::numbers::pi * fraction(n * golden))};
}

}  // namespace

ByChance twins_by_chance(const FeatureState& one, int robot_1, const FeatureState& two, int robot_2,
                         const RobotAlignment& alignment, const FusionOptions& fusion,
                         const TwinOptions& options) {
  std::vector<double> counts;
  for (std::size_t k = 0; k < options.decoys; ++k) {
    RobotAlignment other = alignment;
    other.one_from_two = alignment.one_from_two * decoy(k, options.reach_m);
    counts.push_back(static_cast<double>(fuse(one, robot_1, two, robot_2, other, fusion).duplicates.size()));
  }
  const double size = static_cast<double>(counts.size());
  ByChance chance;
  double sum = 0, squares = 0;
  for (const double count : counts) sum += count;
  chance.mean = (sum + 1) / (size + 1);  // never none at all
  for (const double count : counts) squares += std::pow(count - sum / size, 2);
  if (size > 1) chance.spread = std::max(1.0, squares / (size - 1) / chance.mean);
  return chance;
}

double twins_log_odds(std::size_t twins, const ByChance& by_chance) {
  const double n = static_cast<double>(twins), mean = by_chance.mean;
  const double ratio = (n > 0 ? n * std::log(n / mean) : 0) - (n - mean);
  return n > mean ? std::max(0.0, ratio / by_chance.spread - std::log1p(n)) : -ratio / by_chance.spread;
}

}  // namespace isthmus
