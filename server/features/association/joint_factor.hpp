#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>
#include <vector>

#include "server/features/state/correction.hpp"

namespace isthmus {

/// The Cholesky factor of the joint innovation covariance of several measurements, grown one by one and
/// shrunk again: what the next one says, given those before it. The same as if the state had been corrected
/// by them in turn.
class JointFactor {
 public:
  /// `rows` to begin with; it grows.
  explicit JointFactor(Eigen::Index rows = 64) : factor_(rows, rows), whitened_(rows) {}

  Eigen::Index rows() const { return rows_; }

  /// Adds a measurement: `own` is its innovation covariance, `cross(k)` its covariance with the k-th member
  /// (its rows by that one's). Returns its squared distance given the members; nothing, and nothing added,
  /// where `own` given the members is not positive definite or that distance is `bound` or more.
  template <class Cross>
  std::optional<double> append(const LocalVector& residual, const LocalMatrix& own, double bound,
                               Cross&& cross) {
    const Eigen::Index size = residual.size();
    make_room(rows_ + size);
    auto below = factor_.block(rows_, 0, size, rows_);
    for (std::size_t k = 0; k < starts_.size(); ++k) {
      const LocalMatrix& block = cross(k);
      below.middleCols(starts_[k], block.cols()) = block;
    }
    if (rows_ > 0)
      factor_.topLeftCorner(rows_, rows_)
          .triangularView<Eigen::Lower>()
          .transpose()
          .template solveInPlace<Eigen::OnTheRight>(below);
    const Eigen::LLT<LocalMatrix> rest(LocalMatrix(own - below * below.transpose()));
    if (rest.info() != Eigen::Success) return std::nullopt;
    const LocalVector white = rest.matrixL().solve(residual - below * whitened_.head(rows_));
    if (!(white.squaredNorm() < bound)) return std::nullopt;
    factor_.block(rows_, rows_, size, size) = rest.matrixL();
    whitened_.segment(rows_, size) = white;
    starts_.push_back(rows_);
    rows_ += size;
    return white.squaredNorm();
  }

  /// Of the last one given those before it, by its rows from the `skip`-th on, given those it skips: twice
  /// the negative logarithm of its density, without that of 2π.
  double minus_two_log_density(Eigen::Index skip) const {
    const Eigen::Index from = starts_.back() + skip, size = rows_ - from;
    double sum = whitened_.segment(from, size).squaredNorm();
    for (Eigen::Index k = from; k < rows_; ++k) sum += 2 * std::log(factor_(k, k));
    return sum;
  }

  /// Takes the last one away.
  void pop() {
    rows_ = starts_.back();
    starts_.pop_back();
  }

 private:
  void make_room(Eigen::Index rows) {
    if (rows <= factor_.rows()) return;
    factor_.conservativeResize(2 * rows, 2 * rows);
    whitened_.conservativeResize(2 * rows);
  }

  Eigen::MatrixXd factor_;
  Eigen::VectorXd whitened_;
  std::vector<Eigen::Index> starts_;
  Eigen::Index rows_ = 0;
};

}  // namespace isthmus
