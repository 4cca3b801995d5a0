#include "server/feature_maps/merging/placing_judgement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/feature_maps/merging/placing_search.hpp"

namespace isthmus {
namespace {

std::vector<PlacingAccount> accounts_of(const MapSketch& one, const MapSketch& two,
                                        const MergingOptions& options) {
  std::vector<PlacingAccount> accounts;
  for (const Pose& start : propose_placings(one, two, options)) {
    const Pose placing = refined_placing(one, two, start, options);
    const bool is_known = std::any_of(accounts.begin(), accounts.end(), [&](const PlacingAccount& known) {
      return is_same_placing(known.one_from_two, placing, two.middle, options);
    });
    if (!is_known) accounts.push_back(account_of(one, two, placing, options));
  }
  return accounts;
}

double own_log_odds(const PlacingAccount& account, const MergingOptions& options) {
  return options.log_odds_per_wall * static_cast<double>(account.explained) -
         options.log_odds_per_contradiction * account.contradicted - options.against_any;
}

/// Walls that the one explains and that lie where nothing is known by the other.
double left_unseen(const PlacingAccount& best, const PlacingAccount& other) {
  double sum = 0;
  for (std::size_t i = 0; i < best.of_two.size(); ++i)
    if (best.of_two[i] == WallFate::explained && other.of_two[i] == WallFate::beyond) ++sum;
  return sum;
}

/// The log of how much likelier the best placing is than another.
double lead(const PlacingAccount& best, const PlacingAccount& other, const MergingOptions& options) {
  const double gap = own_log_odds(best, options) - own_log_odds(other, options);
  const auto explained = static_cast<double>(best.explained), others = static_cast<double>(other.explained);
  if (others < options.rival_share * explained) return gap;
  const double shared = std::min(left_unseen(best, other), std::max(0.0, explained - others));
  return gap - options.log_odds_per_wall * shared;
}

/// Whether two placings take mostly the same walls for one another: then one is the other, bent a little.
bool pairs_alike(const PlacingAccount& best, const PlacingAccount& other) {
  const auto common = std::count_if(other.twins.begin(), other.twins.end(), [&](const WallTwin& twin) {
    return std::any_of(best.twins.begin(), best.twins.end(),
                       [&](const WallTwin& known) { return known.one == twin.one && known.two == twin.two; });
  });
  return 2 * static_cast<std::size_t>(common) > other.twins.size();
}

/// Whether what is shared is more than one corridor, and not all that either map has.
bool tells(const PlacingAccount& account, const MergingOptions& options) {
  if (account.across < options.min_across) return false;
  const double enough = std::max(static_cast<double>(options.min_beyond),
                                 options.beyond_share * static_cast<double>(account.explained));
  return account.explained >= options.whole || static_cast<double>(account.beyond) >= enough;
}

}  // namespace

std::optional<PlacingJudgement> judge_placings(const MapSketch& one, const MapSketch& two,
                                               const MergingOptions& options) {
  const std::vector<PlacingAccount> accounts = accounts_of(one, two, options);
  const auto best = std::max_element(accounts.begin(), accounts.end(),
                                     [&](const PlacingAccount& a, const PlacingAccount& b) {
                                       return own_log_odds(a, options) < own_log_odds(b, options);
                                     });
  if (best == accounts.end() || own_log_odds(*best, options) <= 0 || !tells(*best, options))
    return std::nullopt;
  double against = std::exp(-own_log_odds(*best, options));
  for (auto other = accounts.begin(); other != accounts.end(); ++other)
    if (other != best && !pairs_alike(*best, *other)) against += std::exp(-lead(*best, *other, options));
  return PlacingJudgement{*best, -std::log(against)};
}

std::vector<WallTwin> surest_twins(const MapSketch& one, const PlacingAccount& account,
                                   const MergingOptions& options) {
  const auto middle_of = [&](const WallTwin& twin) {
    const MapWall& wall = one.walls[twin.one];
    return Eigen::Vector2d(0.5 * (wall.a + wall.b));
  };
  std::size_t most = 0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const WallTwin& twin : account.twins) {
    const auto beside = static_cast<std::size_t>(
        std::count_if(account.twins.begin(), account.twins.end(), [&](const WallTwin& other) {
          return (middle_of(other) - middle_of(twin)).norm() < options.view_reach_m;
        }));
    if (beside <= most) continue;
    most = beside;
    centre = middle_of(twin);
  }
  std::vector<WallTwin> nearest = account.twins;
  std::erase_if(nearest, [&](const WallTwin& twin) { return twin.off_m > options.seed_m; });
  std::stable_sort(nearest.begin(), nearest.end(), [&](const WallTwin& a, const WallTwin& b) {
    return (middle_of(a) - centre).norm() < (middle_of(b) - centre).norm();
  });
  std::vector<WallTwin> seeds;
  std::array<std::size_t, 2> taken{};
  for (const WallTwin& twin : nearest) {
    const bool is_known = std::any_of(seeds.begin(), seeds.end(), [&](const WallTwin& other) {
      return other.one == twin.one || other.two == twin.two;
    });
    if (is_known) continue;
    const Eigen::Vector2d& first = one.walls[(seeds.empty() ? twin : seeds.front()).one].along;
    std::size_t& of_direction =
        taken[std::abs(one.walls[twin.one].along.dot(first)) > std::sqrt(0.5) ? 0 : 1];
    if (of_direction >= options.seeds_per_direction) continue;
    ++of_direction;
    seeds.push_back(twin);
  }
  if (std::min(taken[0], taken[1]) < 2) return {};
  return seeds;
}

}  // namespace isthmus
