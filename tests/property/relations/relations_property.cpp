#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <Eigen/Eigenvalues>

#include "relations/confidence.hpp"
#include "relations/fit.hpp"
#include "relations/residuals.hpp"
#include "tests/unit/relations/small_maps.hpp"

namespace isthmus {
namespace {

using namespace small_maps;

std::mt19937 any_random() { return std::mt19937(*rc::gen::arbitrary<std::uint32_t>()); }

double sum_of(const std::vector<PointOnLine>& points, const Pose& a_from_b) {
  double sum = 0;
  for (const PointOnLine& p : points) sum += 0.5 * std::pow(p.residual(a_from_b), 2);
  return sum;
}

TEST(QuadraticForm, CostsTheSumOverItsCorrespondencesAtAnyPoseAndAtTheOptimum) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random = any_random();
    const Pose truth = random_pose(random, 20);
    const auto points = points_on_walls(random, truth, *rc::gen::inRange(4, 300), {0.3, 1.8, 1}, 0.01);
    const QuadraticForm form = correspondences(points).form;
    const Pose elsewhere = random_pose(random, 20);
    const Pose optimum = form.minimum(truth).a_from_b;
    for (const Pose& pose : {truth, elsewhere, optimum}) {
      const double sum = sum_of(points, pose);
      RC_ASSERT(std::abs(form.cost(pose) - sum) <= 1e-9 * sum);
    }
  }));
}

TEST(QuadraticForm, MinimumIsAStationaryPointNoDearerThanItsStart) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random = any_random();
    const Pose truth = random_pose(random);
    const QuadraticForm form = correspondences(points_on_walls(random, truth, 30, {0.3, 1.8}, 0.1)).form;
    const Pose start = truth * random_pose(random, 0.5);
    const QuadraticForm::Minimum minimum = form.minimum(start);
    RC_ASSERT(minimum.cost <= form.cost(start) * (1 + 1e-12));
    const Eigen::Vector3d gradient =
        form.jacobian(minimum.a_from_b).transpose() * form.residuals(minimum.a_from_b);
    const Eigen::Vector3d scale = form.information(minimum.a_from_b).diagonal().cwiseSqrt();
    RC_ASSERT(gradient.cwiseQuotient(scale).norm() < 1e-6 * (1 + std::sqrt(minimum.cost)));
    RC_ASSERT(form.least().cost <= minimum.cost * (1 + 1e-9));
  }));
}

Measurement any_measurement(std::mt19937& random, int kind) {
  switch (kind) {
    case 0:
      return correspondences(points_on_walls(random, random_pose(random), 15, {0, 1.2}, 1));
    case 1:
      return RelativePose{random_pose(random), random_information(random)};
    case 2:
      return Range{random_point(random), random_point(random), uniform(random, 0, 9), 0.2};
    default:
      return Bearing{random_pose(random), random_point(random), uniform(random, -3, 3), 0.1};
  }
}

TEST(Residuals, JacobiansOfEveryKindAreTheNumericOnes) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random = any_random();
    const Measurement measured = any_measurement(random, *rc::gen::inRange(0, 4));
    const Pose pose = random_pose(random);
    if (const auto* range = std::get_if<Range>(&measured))
      RC_PRE((pose * range->point_b - range->point_a).norm() > 0.1);
    if (const auto* bearing = std::get_if<Bearing>(&measured))
      RC_PRE((inverse(bearing->a_from_observer) * (pose * bearing->point_b)).norm() > 0.1);
    const LinearResidual residual = linearise(measured, pose);
    RC_ASSERT(residual.rows == residual_rows(measured));
    for (int k = 0; k < 3; ++k) {
      constexpr double step = 1e-6;
      const Eigen::Vector3d move = step * Eigen::Vector3d::Unit(k);
      const auto up = linearise(measured, to_pose(to_vector(pose) + move)).e;
      const auto down = linearise(measured, to_pose(to_vector(pose) - move)).e;
      RC_PRE((up - down).norm() < 1);  // not across the wrap of an angle
      const Eigen::Matrix<double, 5, 1> numeric = (up - down) / (2 * step);
      RC_ASSERT((numeric - residual.by_a_from_b.col(k)).norm() < 1e-5 * (1 + numeric.norm()));
    }
  }));
}

TEST(Residuals, SquareRootOfAnyInformationGivesItsQuadraticForm) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random = any_random();
    Eigen::Matrix3d information = random_information(random);
    if (*rc::gen::arbitrary<bool>()) {
      const Eigen::Vector3d missing = to_vector(random_pose(random)).normalized();
      const Eigen::Matrix3d project = Eigen::Matrix3d::Identity() - missing * missing.transpose();
      information = project * information * project;
    }
    const Eigen::Vector3d r = to_vector(random_pose(random));
    const double expected = r.dot(information * r);
    RC_ASSERT(std::abs((square_root_information(information) * r).squaredNorm() - expected) <
              1e-9 * (1 + expected));
  }));
}

TEST(RelativeCovariance, ExactIsTheInverseOfTheReducedInformationWhicheverPatchIsHeld) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random = any_random();
    const int patches = *rc::gen::inRange(2, 25);
    const SmallMap map = random_map(random, patches, *rc::gen::inRange(0, 40), 0.05);
    const int a = *rc::gen::inRange(0, patches);
    const std::vector<PatchId> others = map.graph.patches_of(PatchId{0});
    const auto exact = exact_relative_covariances(map.graph, map.truth, PatchId{a}, others);
    RC_ASSERT(exact.size() == others.size());
    const Eigen::MatrixXd information = dense_information(map.graph, map.truth);
    const Eigen::MatrixXd covariance = dense_covariance(information, *rc::gen::inRange(0, patches));
    for (int b = 0; b < patches; ++b) {
      if (b == a) continue;
      const Eigen::Matrix3d expected = relative_covariance(covariance, map.truth, a, b);
      RC_ASSERT((exact[static_cast<std::size_t>(b)] - expected).norm() < 1e-7 * expected.norm());
    }
  }));
}

TEST(RelativeCovariance, LocalNeverUndercutsExact) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random = any_random();
    const int patches = *rc::gen::inRange(5, 60);
    const SmallMap map = random_map(random, patches, 2 * patches, 0.05);
    const PatchId a{*rc::gen::inRange(0, patches)};
    const auto most = static_cast<std::size_t>(*rc::gen::inRange(2, patches + 1));
    const auto local = local_relative_covariances(map.graph, map.truth, a, most);
    const std::vector<PatchId> others = map.graph.patches_of(PatchId{0});
    const auto exact = exact_relative_covariances(map.graph, map.truth, a, others);
    RC_ASSERT(local.size() <= most - 1);
    for (const auto& [patch, covariance] : local) {
      const Eigen::Matrix3d excess = covariance - exact[static_cast<std::size_t>(patch.value)];
      const double least = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(excess).eigenvalues()(0);
      RC_ASSERT(least >= -1e-9 * covariance.norm());
    }
  }));
}

TEST(RelativeCovariance, SurvivesWhateverIsNotDetermined) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random = any_random();
    const int patches = *rc::gen::inRange(2, 20);
    SmallMap map(patches);
    for (Pose& pose : map.truth) pose = random_pose(random);
    for (int i = 1; i < patches; ++i) {
      const int to = static_cast<int>(random() % static_cast<unsigned>(i));
      map.graph.add(relation(to, i, any_measurement(random, static_cast<int>(random() % 4))));
    }
    const Eigen::MatrixXd information = dense_information(map.graph, map.truth);
    std::vector<int> kept;
    for (int i = 3; i < 3 * patches; ++i) kept.push_back(i);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information(kept, kept));
    for (const auto& [patch, covariance] : local_relative_covariances(map.graph, map.truth, PatchId{0})) {
      RC_ASSERT(covariance.allFinite());
      // What is claimed to be determined has no share in any null direction.
      for (Eigen::Index k = 0; k < eigen.eigenvalues().size(); ++k) {
        if (eigen.eigenvalues()(k) > 1e-9) break;
        const Eigen::Vector3d share = eigen.eigenvectors().col(k).segment<3>(3 * (patch.value - 1));
        if (covariance.diagonal().maxCoeff() < 1) RC_ASSERT(share.norm() < 1e-3);
      }
    }
    (void)exact_relative_covariances(map.graph, map.truth, PatchId{0}, map.graph.patches_of(PatchId{0}));
  }));
}

TEST(Fit, GradientVanishesAtTheOptimumInEveryFreePatch) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random = any_random();
    const SmallMap map = random_map(random, 12, 20, 0.05);
    std::vector<Pose> poses = disturbed(random, map.truth, 0.05);
    FitOptions options;
    options.max_iterations = 100;
    options.function_tolerance = 1e-14;
    RC_ASSERT(fit_island(map.graph, PatchId{0}, poses, options).ok);
    const auto total = [&] {
      double sum = 0;
      for (const auto& [id, r] : map.graph.relations())
        sum += cost(r, ominus(poses[static_cast<std::size_t>(r.b.value)],
                              poses[static_cast<std::size_t>(r.a.value)]));
      return sum;
    };
    const double least = total();
    for (std::size_t i = 1; i < poses.size(); ++i) {
      const Pose fitted = poses[i];
      for (const Pose& step : {Pose{1e-3, 0, 0}, Pose{-1e-3, 0, 0}, Pose{0, 1e-3, 0}, Pose{0, -1e-3, 0},
                               Pose{0, 0, 1e-3}, Pose{0, 0, -1e-3}}) {
        poses[i] = fitted * step;
        RC_ASSERT(total() >= least * (1 - 1e-9));
      }
      poses[i] = fitted;
    }
  }));
}

}  // namespace
}  // namespace isthmus
