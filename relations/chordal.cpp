#include "relations/chordal.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "relations/block_cholesky.hpp"
#include "relations/residuals.hpp"

namespace isthmus {
namespace {

using Block = Eigen::Matrix2d;
using Vector = Eigen::Vector2d;

/// Information on the yaw with the translation unknown.
double marginal_yaw_information(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(information.topLeftCorner<2, 2>());
  double left = information(2, 2);
  for (int k = 0; k < 2; ++k) {
    const double value = eigen.eigenvalues()(k);
    const double coupling = eigen.eigenvectors().col(k).dot(information.block<2, 1>(0, 2));
    if (value > 1e-10 * eigen.eigenvalues()(1)) left -= coupling * coupling / value;
  }
  return left > 1e-10 * information(2, 2) ? left : 0;
}

struct RelativeYaw {
  double yaw = 0;
  double information = 0;
};

RelativeYaw relative_yaw(const Measurement& measurement) {
  if (const auto* measured = std::get_if<Correspondences>(&measurement))
    return {measured->least.a_from_b.yaw,
            marginal_yaw_information(measured->form.information(measured->least.a_from_b))};
  if (const auto* measured = std::get_if<RelativePose>(&measurement))
    return {measured->a_from_b.yaw, marginal_yaw_information(measured->information)};
  return {};
}

bool is_linear(const Measurement& measurement) {
  return std::holds_alternative<Correspondences>(measurement) ||
         std::holds_alternative<RelativePose>(measurement);
}

/// Normal equations of Σ |J_a δ_a + J_b δ_b + e|² over two-vectors δ of the free patches.
class NormalEquations {
 public:
  explicit NormalEquations(const FitProblem& problem)
      : problem_(problem), matrix_(problem.free_count, pairs(problem)), right_(at(problem.free_count)) {
    clear();
  }

  void clear() {
    matrix_.clear();
    right_.assign(right_.size(), Vector::Zero());
  }

  /// A term with J_aᵀJ_a = `aa`, and so on; `ga` = J_aᵀe, `gb` = J_bᵀe.
  void add(const FitProblem::Link& link, const Block& aa, const Block& ab, const Block& bb, const Vector& ga,
           const Vector& gb) {
    if (problem_.is_free(link.a)) {
      matrix_.add_diagonal(link.a, aa);
      right_[at(link.a)] -= ga;
    }
    if (problem_.is_free(link.b)) {
      matrix_.add_diagonal(link.b, bb);
      right_[at(link.b)] -= gb;
    }
    if (problem_.is_free(link.a) && problem_.is_free(link.b)) matrix_.add(link.a, link.b, ab);
  }

  bool partly_deficient() const { return matrix_.partly_deficient(); }

  std::span<const Vector> solve() {
    matrix_.factor();
    matrix_.solve(right_);
    return right_;
  }

 private:
  static std::vector<std::pair<int, int>> pairs(const FitProblem& problem) {
    std::vector<std::pair<int, int>> found;
    for (const FitProblem::Link& link : problem.links)
      if (problem.is_free(link.a) && problem.is_free(link.b)) found.emplace_back(link.a, link.b);
    return found;
  }

  const FitProblem& problem_;
  BlockCholesky<2> matrix_;
  std::vector<Vector> right_;
};

Vector direction(double yaw) { return {std::cos(yaw), std::sin(yaw)}; }

void solve_yaws(const FitProblem& problem, NormalEquations& equations, std::vector<Pose>& poses) {
  for (const FitProblem::Link& link : problem.links) {
    const RelativeYaw measured = relative_yaw(link.relation->measurement);
    if (measured.information <= 0) continue;
    const Block turn = Eigen::Rotation2Dd(measured.yaw).toRotationMatrix();
    const Vector e = direction(poses[at(link.b)].yaw) - turn * direction(poses[at(link.a)].yaw);
    const Block weight = measured.information * Block::Identity();
    equations.add(link, weight, -measured.information * turn.transpose(), weight,
                  -measured.information * (turn.transpose() * e), measured.information * e);
  }
  const std::span<const Vector> change = equations.solve();
  for (int i = 0; i < problem.free_count; ++i) {
    const Vector u = direction(poses[at(i)].yaw) + change[at(i)];
    if (u.squaredNorm() > 1e-12) poses[at(i)].yaw = std::atan2(u.y(), u.x());
  }
}

void solve_translations(const FitProblem& problem, NormalEquations& equations, std::vector<Pose>& poses) {
  for (const FitProblem::Link& link : problem.links) {
    if (!is_linear(link.relation->measurement)) continue;
    const Pose& a = poses[at(link.a)];
    const LinearResidual residual = linearise(link.relation->measurement, ominus(poses[at(link.b)], a));
    const Eigen::Matrix<double, 5, 2> by_b =
        residual.by_a_from_b.leftCols<2>() * Eigen::Rotation2Dd(-a.yaw).toRotationMatrix();
    const Block bb = by_b.transpose() * by_b;
    const Vector gb = by_b.transpose() * residual.e;
    equations.add(link, bb, -bb, bb, -gb, gb);
  }
  const std::span<const Vector> change = equations.solve();
  for (int i = 0; i < problem.free_count; ++i) {
    poses[at(i)].x += change[at(i)].x();
    poses[at(i)].y += change[at(i)].y();
  }
}

}  // namespace

std::optional<std::vector<Pose>> chordal_poses(const FitProblem& problem, std::span<const Pose> given) {
  std::vector<Pose> poses(given.begin(), given.end());
  NormalEquations equations(problem);
  solve_yaws(problem, equations, poses);
  equations.clear();
  solve_translations(problem, equations, poses);
  if (equations.partly_deficient()) return std::nullopt;
  return poses;
}

}  // namespace isthmus
