#include "relations/fit.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

#include "relations/chordal.hpp"
#include "relations/fit_problem.hpp"
#include "relations/residuals.hpp"

namespace isthmus {
namespace {

/// One relation's residuals (residuals.hpp) by the (x, y, yaw) in the plane of those of its ends that are
/// free: the chain rule through a_from_b = b ⊖ a.
class RelationCost : public ceres::CostFunction {
 public:
  RelationCost(const Relation& relation, const Pose* held_a, const Pose* held_b)
      : measurement_(relation.measurement), held_a_(held_a), held_b_(held_b) {
    set_num_residuals(residual_rows(measurement_));
    mutable_parameter_block_sizes()->assign(held_a || held_b ? 1 : 2, 3);
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const double* const last = parameters[held_a_ || held_b_ ? 0 : 1];
    const Pose pose_a = held_a_ ? *held_a_ : Pose{parameters[0][0], parameters[0][1], parameters[0][2]};
    const Pose pose_b = held_b_ ? *held_b_ : Pose{last[0], last[1], last[2]};
    const LinearResidual residual = linearise(measurement_, ominus(pose_b, pose_a));
    std::copy_n(residual.e.data(), residual.rows, residuals);
    if (!jacobians) return true;
    const OminusJacobians chain = ominus_jacobians(pose_b, pose_a);
    int block = 0;
    if (!held_a_) write(residual, chain.by_pi, jacobians[block++]);
    if (!held_b_) write(residual, chain.by_q, jacobians[block]);
    return true;
  }

 private:
  static void write(const LinearResidual& residual, const Eigen::Matrix3d& chain, double* jacobian) {
    if (!jacobian) return;
    const Eigen::Matrix<double, 5, 3, Eigen::RowMajor> by_pose = residual.by_a_from_b * chain;
    std::copy_n(by_pose.data(), 3 * residual.rows, jacobian);
  }

  const Measurement& measurement_;
  const Pose* held_a_;
  const Pose* held_b_;
};

/// Cauchy's loss on what a relation costs above its own least (relation.hpp, robust_scale).
class CauchyAboveLeast : public ceres::LossFunction {
 public:
  explicit CauchyAboveLeast(const Relation& relation)
      : squared_scale_(relation.robust_scale * relation.robust_scale) {
    if (const auto* measured = std::get_if<Correspondences>(&relation.measurement))
      least_ = 2 * measured->least.cost;
  }

  void Evaluate(double squared_norm, double rho[3]) const override {
    const double c = std::max(0.0, squared_norm - least_);
    const double weight = 1 / (1 + c / squared_scale_);
    rho[0] = squared_scale_ * std::log1p(c / squared_scale_);
    rho[1] = weight;
    rho[2] = -weight * weight / squared_scale_;
  }

 private:
  double squared_scale_;
  double least_ = 0;
};

/// A Ceres problem over copies of the poses; cost and loss functions live as long as it does.
class Solver {
 public:
  Solver(const FitProblem& problem, std::span<const Pose> poses)
      : held_(poses.begin(), poses.end()), ceres_(problem_options()) {
    parameters_.reserve(at(problem.free_count));
    for (int i = 0; i < problem.free_count; ++i) {
      const Pose& pose = poses[at(i)];
      parameters_.push_back({pose.x, pose.y, pose.yaw});
    }
    for (const FitProblem::Link& link : problem.links) add(problem, link);
  }

  ceres::Solver::Summary solve(const FitOptions& options, double trust_region_radius) {
    ceres::Solver::Options ceres_options;
    ceres_options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    ceres_options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
    ceres_options.num_threads = 1;
    ceres_options.max_num_iterations = options.max_iterations;
    ceres_options.max_solver_time_in_seconds = 1e9;
    ceres_options.function_tolerance = options.function_tolerance;
    ceres_options.initial_trust_region_radius = trust_region_radius;
    // A singular step shrinks the radius 2, 4, 8, ... times: enough to come down from the largest start.
    ceres_options.max_num_consecutive_invalid_steps = 10;
    ceres_options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(ceres_options, &ceres_, &summary);
    return summary;
  }

  std::vector<Pose> poses() const {
    std::vector<Pose> found = held_;
    for (std::size_t i = 0; i < parameters_.size(); ++i)
      found[i] = to_pose({parameters_[i][0], parameters_[i][1], parameters_[i][2]});
    return found;
  }

 private:
  static ceres::Problem::Options problem_options() {
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    return options;
  }

  void add(const FitProblem& problem, const FitProblem::Link& link) {
    const bool free_a = problem.is_free(link.a);
    const bool free_b = problem.is_free(link.b);
    RelationCost& cost = costs_.emplace_back(*link.relation, free_a ? nullptr : &held_[at(link.a)],
                                             free_b ? nullptr : &held_[at(link.b)]);
    ceres::LossFunction* loss = nullptr;
    if (link.relation->robust_scale > 0) loss = &losses_.emplace_back(*link.relation);
    if (free_a && free_b)
      ceres_.AddResidualBlock(&cost, loss, parameters_[at(link.a)].data(), parameters_[at(link.b)].data());
    else
      ceres_.AddResidualBlock(&cost, loss, parameters_[at(free_a ? link.a : link.b)].data());
  }

  std::vector<Pose> held_;
  std::vector<std::array<double, 3>> parameters_;
  std::deque<RelationCost> costs_;
  std::deque<CauchyAboveLeast> losses_;
  ceres::Problem ceres_;
};

struct Attempt {
  bool usable = false;
  double cost = 0;
  int iterations = 0;
  std::string message;
  std::vector<Pose> poses;
};

Attempt attempt(const FitProblem& problem, std::span<const Pose> start, const FitOptions& options,
                double radius) {
  Solver solver(problem, start);
  const ceres::Solver::Summary summary = solver.solve(options, radius);
  Attempt result;
  result.poses = solver.poses();
  result.cost = cost(problem, result.poses);
  result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  result.message = summary.message;
  result.usable = summary.IsSolutionUsable() && std::isfinite(result.cost) &&
                  std::all_of(result.poses.begin(), result.poses.end(), is_finite);
  return result;
}

/// From a chordal start Gauss-Newton's full step is right; from given poses a little damping keeps directions
/// that nothing determines where they are. Ceres' own default is for starts that are far off.
constexpr double chordal_radius = 1e12;
constexpr double warm_radius = 1e8;
constexpr double default_radius = 1e4;

Attempt best_attempt(const FitProblem& problem, const std::vector<Pose>& given, double cost_before,
                     const FitOptions& options) {
  std::vector<Pose> start = given;
  double radius = warm_radius;
  if (options.chordal_start) {
    std::optional<std::vector<Pose>> chordal = chordal_poses(problem, given);
    if (chordal && cost(problem, *chordal) < cost_before) {
      start = std::move(*chordal);
      radius = chordal_radius;
    }
  }
  Attempt first = attempt(problem, start, options, radius);
  if (first.usable && first.cost <= cost_before * (1 + 1e-9)) return first;
  return attempt(problem, given, options, default_radius);
}

}  // namespace

FitReport fit(const RelationGraph& graph, std::span<const PatchId> free, std::span<Pose> poses,
              const FitOptions& options) {
  FitReport report;
  const FitProblem problem = make_fit_problem(graph, free);
  if (problem.links.empty()) {
    report.ok = true;
    report.message = "nothing to fit";
    return report;
  }
  const std::vector<Pose> given = poses_of(problem, poses);
  report.cost_before = report.cost_after = cost(problem, given);
  if (!std::isfinite(report.cost_before)) {
    report.message = "the cost is not finite at the given poses";
    return report;
  }
  const Attempt result = best_attempt(problem, given, report.cost_before, options);
  report.iterations = result.iterations;
  report.message = result.message;
  report.ok = result.usable && result.cost <= report.cost_before * (1 + 1e-9);
  if (!report.ok) return report;
  report.cost_after = result.cost;
  for (int i = 0; i < problem.free_count; ++i)
    poses[static_cast<std::size_t>(problem.patches[at(i)].value)] = result.poses[at(i)];
  return report;
}

FitReport fit_island(const RelationGraph& graph, IslandId island, std::span<Pose> poses,
                     const FitOptions& options) {
  return fit(graph, graph.patches_of(island), poses, options);
}

}  // namespace isthmus
