#include "relations/quadratic_form.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace isthmus {
namespace {

/// Columns of R below this share of the largest are taken as no information at all.
constexpr double rank_tolerance = 1e-9;

/// Of Newton's method on the yaw, which doubles its digits each time once it is near.
constexpr int max_iterations = 50;

double squared_scale(const Matrix5d& r) { return r.topLeftCorner<5, 4>().colwise().squaredNorm().maxCoeff(); }

/// The form with its translation eliminated: |R v|² at the best (x, y) for a yaw is |B (cos, sin, 1)|².
/// The translation columns are rotated away by an orthogonal matrix, so no digits are lost.
class YawProblem {
 public:
  explicit YawProblem(const Matrix5d& r) {
    Eigen::ColPivHouseholderQR<Eigen::Matrix<double, 5, 2>> translation(r.middleCols<2>(2));
    const Eigen::Vector2d pivots = translation.matrixR().diagonal().cwiseAbs();
    const double min_pivot = rank_tolerance * std::sqrt(squared_scale(r));
    const Eigen::Index rank = (pivots.array() > min_pivot).count();
    b_.leftCols<2>() = r.leftCols<2>();
    b_.col(2) = r.col(4);
    b_.applyOnTheLeft(translation.householderQ().adjoint());
    b_.topRows(rank).setZero();
    scale_ = squared_scale(r);
  }

  double cost(double yaw) const { return 0.5 * value(yaw).squaredNorm(); }

  /// Newton's method on the one angle, with the absolute value of the curvature, so that it leaves a maximum
  /// as fast as it approaches a minimum (Nocedal and Wright, Numerical Optimization, 2nd ed., section 3.4).
  double minimise(double yaw) const {
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
      const Eigen::Matrix<double, 5, 1> e = value(yaw);
      const Eigen::Matrix<double, 5, 1> de =
          b_.leftCols<2>() * Eigen::Vector2d(-std::sin(yaw), std::cos(yaw));
      const double gradient = e.dot(de);
      const double gauss_newton = de.squaredNorm();
      if (gauss_newton <= rank_tolerance * rank_tolerance * scale_) return yaw;
      const double newton =
          gauss_newton - e.dot(b_.leftCols<2>() * Eigen::Vector2d(std::cos(yaw), std::sin(yaw)));
      double step = -gradient / std::max(std::abs(newton), 1e-4 * gauss_newton);
      if (std::abs(step) > 0.5) step = std::copysign(0.5, step);
      const double before = 0.5 * e.squaredNorm();
      while (cost(yaw + step) > before && std::abs(step) > 1e-15) step *= 0.5;
      yaw += step;
      if (std::abs(step) < 1e-13) break;
    }
    return yaw;
  }

 private:
  Eigen::Matrix<double, 5, 1> value(double yaw) const {
    return b_ * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 1);
  }

  Eigen::Matrix<double, 5, 3> b_;
  double scale_ = 0;
};

/// The translation of least cost at a yaw; the smallest change from `start`, so that directions without
/// information stay.
Eigen::Vector2d best_translation(const Matrix5d& r, double yaw, const Eigen::Vector2d& start) {
  const Vector5d e = r * form_variables({start.x(), start.y(), yaw});
  Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix<double, 5, 2>> translation;
  translation.setThreshold(rank_tolerance);
  const Eigen::Matrix<double, 5, 2> columns = r.middleCols<2>(2);
  if (columns.squaredNorm() <= rank_tolerance * rank_tolerance * squared_scale(r)) return start;
  translation.compute(columns);
  return start - translation.solve(e);
}

QuadraticForm::Minimum at_yaw(const Matrix5d& r, double yaw, const Eigen::Vector2d& start) {
  const Eigen::Vector2d t = best_translation(r, yaw, start);
  const Pose best{t.x(), t.y(), wrap_angle(yaw)};
  return {best, QuadraticForm{r}.cost(best)};
}

}  // namespace

Vector5d form_variables(const Pose& a_from_b) {
  Vector5d v;
  v << std::cos(a_from_b.yaw), std::sin(a_from_b.yaw), a_from_b.x, a_from_b.y, 1;
  return v;
}

double QuadraticForm::cost(const Pose& a_from_b) const { return 0.5 * residuals(a_from_b).squaredNorm(); }

Vector5d QuadraticForm::residuals(const Pose& a_from_b) const {
  const Vector5d v = form_variables(a_from_b);
  Vector5d e;  // row by row: Eigen's triangular product is for larger ones
  e << r.row(0).dot(v), r.row(1).tail<4>().dot(v.tail<4>()), r.row(2).tail<3>().dot(v.tail<3>()),
      r.row(3).tail<2>().dot(v.tail<2>()), r(4, 4) * v(4);
  return e;
}

Eigen::Matrix<double, 5, 3> QuadraticForm::jacobian(const Pose& a_from_b) const {
  Eigen::Matrix<double, 5, 3> jacobian;
  jacobian.leftCols<2>() = r.middleCols<2>(2);
  jacobian.col(2) = std::cos(a_from_b.yaw) * r.col(1) - std::sin(a_from_b.yaw) * r.col(0);
  return jacobian;
}

Eigen::Matrix3d QuadraticForm::information(const Pose& a_from_b) const {
  const Eigen::Matrix<double, 5, 3> j = jacobian(a_from_b);
  return j.transpose() * j;
}

QuadraticForm::Minimum QuadraticForm::minimum(const Pose& start) const {
  return at_yaw(r, YawProblem(r).minimise(start.yaw), {start.x, start.y});
}

QuadraticForm::Minimum QuadraticForm::least() const {
  // Over the circle the eliminated cost is a trigonometric polynomial of degree two: at most two minima, and
  // twelve samples part them.
  constexpr int samples = 12;
  const YawProblem problem(r);
  double best_yaw = 0;
  double min_cost = problem.cost(0);
  const auto angle = [](int i) { return 2 * std::numbers::pi * i / samples; };
  for (int i = 0; i < samples; ++i) {
    const double here = problem.cost(angle(i));
    if (here > problem.cost(angle(i - 1)) || here > problem.cost(angle(i + 1))) continue;
    const double yaw = problem.minimise(angle(i));
    const double polished = problem.cost(yaw);
    if (polished >= min_cost) continue;
    min_cost = polished;
    best_yaw = yaw;
  }
  return at_yaw(r, best_yaw, Eigen::Vector2d::Zero());
}

void QuadraticFormBuilder::row(const Vector5d& coefficients) { rows_.push_back(coefficients); }

void QuadraticFormBuilder::point_on_line(const Eigen::Vector2d& p, const Eigen::Vector2d& q,
                                         const Eigen::Vector2d& n, double sigma_m) {
  Vector5d coefficients;
  coefficients << n.dot(p), n.y() * p.x() - n.x() * p.y(), n.x(), n.y(), -n.dot(q);
  row(coefficients / sigma_m);
}

QuadraticForm QuadraticFormBuilder::build() const {
  QuadraticForm form;
  if (rows_.empty()) return form;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 5>;
  const auto count = static_cast<Eigen::Index>(rows_.size());
  Rows stacked = Rows::Zero(std::max<Eigen::Index>(count, 5), 5);
  for (Eigen::Index i = 0; i < count; ++i) stacked.row(i) = rows_[static_cast<std::size_t>(i)].transpose();
  const Eigen::HouseholderQR<Eigen::Ref<Rows>> qr(stacked);
  form.r = stacked.topRows<5>().triangularView<Eigen::Upper>();
  return form;
}

}  // namespace isthmus
