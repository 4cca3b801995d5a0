#pragma once

#include <span>
#include <vector>

#include "server/features/state/state.hpp"

namespace isthmus {

/// A measurement, linear in the state's errors: residual = Σ by · e + noise. At most 4 rows.
struct LinearMeasurement {
  struct Block {
    int offset = 0;
    LocalMatrix by;  ///< rows by the length of those errors
  };
  LocalVector residual;  ///< measured less expected
  LocalMatrix noise;     ///< covariance
  std::vector<Block> blocks;
};

/// H_a P H_bᵀ of two measurements, without noise.
LocalMatrix cross_covariance(const Eigen::MatrixXd& covariance, const LinearMeasurement& a,
                             const LinearMeasurement& b);
/// S = H P Hᵀ + R of one.
LocalMatrix innovation_covariance(const Eigen::MatrixXd& covariance, const LinearMeasurement& measurement);

/// rᵀ S⁻¹ r of one; infinity where S is not positive definite.
double squared_distance(const Eigen::MatrixXd& covariance, const LinearMeasurement& measurement);

/// Corrects the state by independent measurements at once, in Joseph's form: (1 − KH) P (1 − KH)ᵀ + K R Kᵀ,
/// at a cost of n² m for n errors and m rows. The invariant form moves poses and features by the exponential
/// of the correction, and carries the covariance over to where they are then. Where S is not positive
/// definite, or the result not finite, false: the state is as it was.
bool correct(FeatureState& state, std::span<const LinearMeasurement> measurements);

}  // namespace isthmus
