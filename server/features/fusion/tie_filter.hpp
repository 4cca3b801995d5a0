#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "server/features/fusion/tie.hpp"

namespace isthmus {

/// At most 4 by any number.
using Whitened = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, Eigen::Dynamic>;

/// What a tie says given others, the place of the second map held: residual, covariance and by_maps of what
/// is new in it.
struct GivenTie {
  LocalVector residual;
  LocalMatrix covariance;
  ByMaps by_maps;
  Whitened shared;  ///< with those before it, in their whitened rows
};

/// Two maps and the ties between them, without a joint covariance: nothing of n² is touched as ties are
/// added. With S = H P Hᵀ + R = L Lᵀ of all ties, P block-diagonal of the maps as they are, it keeps L and W
/// = L⁻¹ H P; the maps given the ties are then P − WᵀW, and the place of the second in the first, of which
/// nothing is known before, is that of least squares with information VᵀV, V = L⁻¹ by_maps. A further tie
/// costs m n for m rows before it.
class TieFilter {
 public:
  TieFilter(const FeatureState& one, const FeatureState& two);

  /// Without ties again.
  void clear();
  Eigen::Index rows() const { return rows_; }
  const std::vector<Eigen::Index>& starts() const { return starts_; }

  GivenTie given(const MapTie& tie) const;
  /// False, and nothing added, where its covariance given the others is not positive definite.
  bool append(const MapTie& tie);
  bool append(const MapTie& tie, const GivenTie& given);

  /// Once the ties determine it: (VᵀV)⁻¹, and how far the second map then lies from where it was put.
  Eigen::Matrix3d maps_covariance() const;
  Eigen::Vector3d maps_correction() const;

  /// L, V, w = L⁻¹ residual, and Wᵀ of each map: that map's errors by rows().
  auto factor() const { return factor_.topLeftCorner(rows_, rows_); }
  auto by_maps() const { return by_maps_.topRows(rows_); }
  auto residual() const { return residual_.head(rows_); }
  auto gain_one() const { return gain_one_.leftCols(rows_); }
  auto gain_two() const { return gain_two_.leftCols(rows_); }

 private:
  void make_room(Eigen::Index rows);

  const FeatureState* one_;
  const FeatureState* two_;
  Eigen::Index rows_ = 0;
  std::vector<Eigen::Index> starts_;
  Eigen::MatrixXd factor_, gain_one_, gain_two_;
  Eigen::Matrix<double, Eigen::Dynamic, 3> by_maps_;
  Eigen::VectorXd residual_;
};

/// Covariance of two ties by the maps' errors, without noise, those of `filter` given. `a` and `b` are what
/// they say given those.
LocalMatrix cross_covariance(const FeatureState& one, const FeatureState& two, const MapTie& a,
                             const GivenTie& given_a, const MapTie& b, const GivenTie& given_b);

}  // namespace isthmus
