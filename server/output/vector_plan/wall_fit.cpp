#include "server/output/vector_plan/wall_fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "relations/chi_squared.hpp"
#include "server/output/vector_plan/line_grid.hpp"

namespace isthmus {
namespace {

class WallFit {
 public:
  WallFit(std::span<const FeatureSeen> segments, const WallFitOptions& options)
      : options_(options), gate_(chi2_quantile(options.agree_probability, 2)) {
    pieces_.reserve(segments.size());
    for (const FeatureSeen& segment : segments) pieces_.push_back(line_of(segment.observed));
    order_.resize(pieces_.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return pieces_[a].half_m > pieces_[b].half_m; });
  }

  std::vector<FittedWall> run() {
    for (const std::size_t piece : order_) take(piece);
    join_walls();
    for (int round = 0; round < options_.rounds; ++round) {
      share_out();
      join_walls();
    }
    return finished();
  }

 private:
  struct Wall {
    WallLine line;
    std::vector<std::size_t> pieces;
  };

  /// The squared distance of two lines, in sigmas; nothing where they are not one wall.
  std::optional<double> agreement(const WallLine& one, const WallLine& other) const {
    if (one.along.dot(other.along) < std::cos(options_.max_turn_rad)) return std::nullopt;
    const LineDifference apart = difference(one, other);
    if (apart.gap_m > options_.max_gap_m || std::abs(apart.step_m) > options_.max_step_m) return std::nullopt;
    Eigen::Matrix2d covariance = apart.covariance;
    covariance(0, 0) += std::pow(options_.straight_sigma_rad, 2);
    covariance(1, 1) += std::pow(options_.straight_sigma_m, 2);
    const Eigen::Vector2d offset(apart.turn_rad, apart.step_m);
    const double squared = offset.dot(covariance.inverse() * offset);
    if (!(squared < gate_)) return std::nullopt;
    return squared;
  }

  /// The wall that a line agrees with best, other than `own`.
  std::optional<int> best_for(const WallLine& line, int own) const {
    const double reach = line.half_m + options_.max_gap_m;
    std::optional<int> best;
    double least = 0;
    for (const int i : grid_.near(line.at(-reach), line.at(reach))) {
      const Wall& wall = walls_[static_cast<std::size_t>(i)];
      if (i == own || wall.pieces.empty()) continue;
      const std::optional<double> squared = agreement(wall.line, line);
      if (!squared || (best && *squared >= least)) continue;
      best = i;
      least = *squared;
    }
    return best;
  }

  void take(std::size_t piece) {
    const WallLine& line = pieces_[piece];
    if (const std::optional<int> wall = best_for(line, -1)) {
      Wall& found = walls_[static_cast<std::size_t>(*wall)];
      found.line = joined(found.line, line);
      found.pieces.push_back(piece);
      put_in_grid(*wall);
      return;
    }
    walls_.push_back({line, {piece}});
    put_in_grid(static_cast<int>(walls_.size()) - 1);
  }

  void put_in_grid(int wall) {
    const WallLine& line = walls_[static_cast<std::size_t>(wall)].line;
    grid_.insert(wall, line.at(-line.half_m), line.at(line.half_m));
  }

  /// Each join leaves one wall less, so this ends.
  void join_walls() {
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < walls_.size(); ++i) {
        if (walls_[i].pieces.empty()) continue;
        const std::optional<int> other = best_for(walls_[i].line, static_cast<int>(i));
        if (!other) continue;
        Wall& gone = walls_[static_cast<std::size_t>(*other)];
        walls_[i].line = joined(walls_[i].line, gone.line);
        walls_[i].pieces.insert(walls_[i].pieces.end(), gone.pieces.begin(), gone.pieces.end());
        gone.pieces.clear();
        put_in_grid(static_cast<int>(i));
        changed = true;
      }
    }
  }

  /// Each piece to the wall that it agrees with best; walls are then fitted to what they have.
  void share_out() {
    std::vector<std::vector<std::size_t>> shares(walls_.size());
    std::vector<std::size_t> lonely;
    for (const std::size_t piece : order_) {
      const std::optional<int> wall = best_for(pieces_[piece], -1);
      if (wall)
        shares[static_cast<std::size_t>(*wall)].push_back(piece);
      else
        lonely.push_back(piece);
    }
    for (const std::size_t piece : lonely) shares.push_back({piece});
    walls_.clear();
    grid_ = {};
    for (std::vector<std::size_t>& share : shares)
      if (!share.empty()) add_fitted(std::move(share));
  }

  void add_fitted(std::vector<std::size_t> share) {
    WallLine line = pieces_[share.front()];
    for (std::size_t k = 1; k < share.size(); ++k) line = joined(line, pieces_[share[k]]);
    walls_.push_back({line, std::move(share)});
    put_in_grid(static_cast<int>(walls_.size()) - 1);
  }

  std::vector<FittedWall> finished() {
    std::vector<FittedWall> fitted;
    for (Wall& wall : walls_) {
      if (wall.pieces.empty()) continue;
      std::sort(wall.pieces.begin(), wall.pieces.end());
      fitted.push_back({wall.line, std::move(wall.pieces)});
    }
    std::stable_sort(fitted.begin(), fitted.end(),
                     [](const FittedWall& a, const FittedWall& b) { return a.line.half_m > b.line.half_m; });
    return fitted;
  }

  const WallFitOptions& options_;
  double gate_ = 0;
  std::vector<WallLine> pieces_;
  std::vector<std::size_t> order_;  ///< longest first
  std::vector<Wall> walls_;         ///< those joined to others have no pieces
  LineGrid grid_;
};

}  // namespace

std::vector<FittedWall> fit_walls(std::span<const FeatureSeen> segments, const WallFitOptions& options) {
  return WallFit(segments, options).run();
}

}  // namespace isthmus
