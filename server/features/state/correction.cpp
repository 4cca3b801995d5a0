#include "server/features/state/correction.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>

#include "server/features/state/invariance.hpp"

namespace isthmus {
namespace {

/// P Hᵀ of all measurements: n by m.
Eigen::MatrixXd times_transposed(const Eigen::MatrixXd& covariance,
                                 std::span<const LinearMeasurement> measurements, Eigen::Index rows) {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(covariance.rows(), rows);
  Eigen::Index at = 0;
  for (const LinearMeasurement& one : measurements) {
    for (const LinearMeasurement::Block& block : one.blocks)
      product.middleCols(at, one.residual.size()).noalias() +=
          covariance.middleCols(block.offset, block.by.cols()) * block.by.transpose();
    at += one.residual.size();
  }
  return product;
}

/// H X for an n by m X.
Eigen::MatrixXd times(std::span<const LinearMeasurement> measurements, const Eigen::MatrixXd& x,
                      Eigen::Index rows) {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(rows, x.cols());
  Eigen::Index at = 0;
  for (const LinearMeasurement& one : measurements) {
    for (const LinearMeasurement::Block& block : one.blocks)
      product.middleRows(at, one.residual.size()).noalias() +=
          block.by * x.middleRows(block.offset, block.by.cols());
    at += one.residual.size();
  }
  return product;
}

struct Stacked {
  Eigen::VectorXd residual;
  Eigen::MatrixXd noise;
};

Stacked stack(std::span<const LinearMeasurement> measurements) {
  Eigen::Index rows = 0;
  for (const LinearMeasurement& one : measurements) rows += one.residual.size();
  Stacked all{Eigen::VectorXd(rows), Eigen::MatrixXd::Zero(rows, rows)};
  Eigen::Index at = 0;
  for (const LinearMeasurement& one : measurements) {
    const Eigen::Index size = one.residual.size();
    all.residual.segment(at, size) = one.residual;
    all.noise.block(at, at, size, size) = one.noise;
    at += size;
  }
  return all;
}

}  // namespace

LocalMatrix cross_covariance(const Eigen::MatrixXd& covariance, const LinearMeasurement& a,
                             const LinearMeasurement& b) {
  LocalMatrix sum = LocalMatrix::Zero(a.residual.size(), b.residual.size());
  for (const LinearMeasurement::Block& left : a.blocks) {
    for (const LinearMeasurement::Block& right : b.blocks) {
      const LocalMatrix between =
          covariance.block(left.offset, right.offset, left.by.cols(), right.by.cols());
      sum += left.by * between * right.by.transpose();
    }
  }
  return sum;
}

LocalMatrix innovation_covariance(const Eigen::MatrixXd& covariance, const LinearMeasurement& measurement) {
  return cross_covariance(covariance, measurement, measurement) + measurement.noise;
}

double squared_distance(const Eigen::MatrixXd& covariance, const LinearMeasurement& measurement) {
  const Eigen::LLT<LocalMatrix> factor(innovation_covariance(covariance, measurement));
  if (factor.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  return measurement.residual.dot(factor.solve(measurement.residual));
}

bool correct(FeatureState& state, std::span<const LinearMeasurement> measurements) {
  const Stacked all = stack(measurements);
  const Eigen::Index rows = all.residual.size();
  if (rows == 0) return true;
  const Eigen::MatrixXd p_ht = times_transposed(state.covariance, measurements, rows);
  const Eigen::MatrixXd s = times(measurements, p_ht, rows) + all.noise;
  const Eigen::LLT<Eigen::MatrixXd> factor(s);
  if (factor.info() != Eigen::Success) return false;
  const Eigen::MatrixXd gain = factor.solve(p_ht.transpose()).transpose();
  const Eigen::VectorXd delta = gain * all.residual;
  Eigen::MatrixXd corrected = state.covariance;  // (1 − KH) P, then times (1 − KH)ᵀ, and K R Kᵀ
  corrected.noalias() -= gain * p_ht.transpose();
  const Eigen::MatrixXd rest = times_transposed(corrected, measurements, rows) - gain * all.noise;
  corrected.noalias() -= rest * gain.transpose();
  if (!delta.allFinite() || !corrected.allFinite()) return false;
  state.covariance = 0.5 * (corrected + corrected.transpose());
  apply_correction(state, delta);
  return true;
}

}  // namespace isthmus
