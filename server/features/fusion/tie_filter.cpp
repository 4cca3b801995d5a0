#include "server/features/fusion/tie_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace isthmus {
namespace {

constexpr Eigen::Index first_rows = 96;  // room for some thirty pairs of points

LocalMatrix between(const Eigen::MatrixXd& p, int offset_a, const LocalMatrix& by_a, int offset_b,
                    const LocalMatrix& by_b) {
  const LocalMatrix half = by_a.lazyProduct(p.block(offset_a, offset_b, by_a.cols(), by_b.cols()));
  return half.lazyProduct(by_b.transpose());
}

}  // namespace

TieFilter::TieFilter(const FeatureState& one, const FeatureState& two)
    : one_(&one),
      two_(&two),
      factor_(Eigen::MatrixXd::Zero(first_rows, first_rows)),
      gain_one_(one.covariance.rows(), first_rows),
      gain_two_(two.covariance.rows(), first_rows),
      by_maps_(first_rows, 3),
      residual_(first_rows) {}

void TieFilter::clear() {
  rows_ = 0;
  starts_.clear();
}

void TieFilter::make_room(Eigen::Index rows) {
  const Eigen::Index old = factor_.rows();
  if (rows <= old) return;
  Eigen::MatrixXd larger = Eigen::MatrixXd::Zero(2 * rows, 2 * rows);
  larger.topLeftCorner(old, old) = factor_;
  factor_ = std::move(larger);
  gain_one_.conservativeResize(Eigen::NoChange, 2 * rows);
  gain_two_.conservativeResize(Eigen::NoChange, 2 * rows);
  by_maps_.conservativeResize(2 * rows, Eigen::NoChange);
  residual_.conservativeResize(2 * rows);
}

// Without ties before it there is nothing to share: matrices without columns have no memory to point to.
GivenTie TieFilter::given(const MapTie& tie) const {
  GivenTie given{tie.residual, tie.noise, tie.by_maps, Whitened(tie.residual.size(), rows_)};
  if (rows_ > 0) {
    const auto gain_one = gain_one_.block(tie.offset_one, 0, tie.by_one.cols(), rows_);
    const auto gain_two = gain_two_.block(tie.offset_two, 0, tie.by_two.cols(), rows_);
    given.shared = tie.by_one.lazyProduct(gain_one);
    given.shared += tie.by_two.lazyProduct(gain_two);
    given.residual -= given.shared.lazyProduct(residual());
    given.by_maps -= given.shared.lazyProduct(by_maps());
    given.covariance -= given.shared.lazyProduct(given.shared.transpose());
  }
  given.covariance += between(one_->covariance, tie.offset_one, tie.by_one, tie.offset_one, tie.by_one);
  given.covariance += between(two_->covariance, tie.offset_two, tie.by_two, tie.offset_two, tie.by_two);
  return given;
}

bool TieFilter::append(const MapTie& tie) { return append(tie, given(tie)); }

bool TieFilter::append(const MapTie& tie, const GivenTie& given) {
  const Eigen::LLT<LocalMatrix> root(given.covariance);
  if (root.info() != Eigen::Success || !given.residual.allFinite()) return false;
  const Eigen::Index size = given.residual.size();
  make_room(rows_ + size);
  const LocalMatrix whiten = root.matrixL().solve(LocalMatrix::Identity(size, size));
  if (rows_ > 0) factor_.block(rows_, 0, size, rows_) = given.shared;
  factor_.block(rows_, rows_, size, size) = root.matrixL();
  residual_.segment(rows_, size) = whiten * given.residual;
  by_maps_.middleRows(rows_, size) = whiten * given.by_maps;
  const Whitened white_shared = whiten * given.shared;
  const auto add = [&](Eigen::MatrixXd& gain, const Eigen::MatrixXd& p, int offset, const LocalMatrix& by) {
    const LocalMatrix white_by = whiten * by;
    for (Eigen::Index k = 0; k < size; ++k) {  // a column at a time: so few are no matrix product
      auto column = gain.col(rows_ + k);
      column.noalias() = p.middleCols(offset, by.cols()) * white_by.row(k).transpose();
      if (rows_ > 0) column.noalias() -= gain.leftCols(rows_) * white_shared.row(k).transpose();
    }
  };
  add(gain_one_, one_->covariance, tie.offset_one, tie.by_one);
  add(gain_two_, two_->covariance, tie.offset_two, tie.by_two);
  starts_.push_back(rows_);
  rows_ += size;
  return true;
}

Eigen::Matrix3d TieFilter::maps_covariance() const {
  const Eigen::Matrix3d information = by_maps().transpose() * by_maps();
  return information.llt().solve(Eigen::Matrix3d::Identity());
}

Eigen::Vector3d TieFilter::maps_correction() const {
  return maps_covariance() * (by_maps().transpose() * residual());
}

LocalMatrix cross_covariance(const FeatureState& one, const FeatureState& two, const MapTie& a,
                             const GivenTie& given_a, const MapTie& b, const GivenTie& given_b) {
  LocalMatrix sum = between(one.covariance, a.offset_one, a.by_one, b.offset_one, b.by_one);
  sum += between(two.covariance, a.offset_two, a.by_two, b.offset_two, b.by_two);
  if (given_a.shared.cols() > 0) sum -= given_a.shared.lazyProduct(given_b.shared.transpose());
  return sum;
}

}  // namespace isthmus
