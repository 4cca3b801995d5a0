#include "relations/block_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "tests/unit/relations/small_maps.hpp"

namespace isthmus {
namespace {

using small_maps::uniform;

/// A sparse system of random springs JᵀJ between block rows, and its dense twin.
template <int N>
struct Springs {
  using Block = Eigen::Matrix<double, N, N>;

  Springs(std::mt19937& random, int size, int springs, int rows_per_spring) {
    for (int k = 0; k < springs; ++k) {
      const int i = static_cast<int>(random() % static_cast<unsigned>(size));
      const int j = static_cast<int>(random() % static_cast<unsigned>(size));
      if (i != j) pairs.emplace_back(i, j);
    }
    dense = Eigen::MatrixXd::Zero(N * size, N * size);
    sparse = std::make_unique<BlockCholesky<N>>(size, pairs);
    for (const auto& [i, j] : pairs) {
      Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(rows_per_spring, 2 * N);
      for (Eigen::Index m = 0; m < jacobian.size(); ++m) jacobian(m) = uniform(random, -1, 1);
      const Eigen::MatrixXd both = jacobian.transpose() * jacobian;
      sparse->add_diagonal(i, both.topLeftCorner<N, N>());
      sparse->add_diagonal(j, both.bottomRightCorner<N, N>());
      sparse->add(i, j, both.topRightCorner<N, N>());
      dense.block<N, N>(N * i, N * i) += both.topLeftCorner<N, N>();
      dense.block<N, N>(N * j, N * j) += both.bottomRightCorner<N, N>();
      dense.block<N, N>(N * i, N * j) += both.topRightCorner<N, N>();
      dense.block<N, N>(N * j, N * i) += both.topRightCorner<N, N>().transpose();
    }
    for (int i = 0; i < size; ++i) {
      sparse->add_diagonal(i, 0.1 * Block::Identity());
      dense.block<N, N>(N * i, N * i) += 0.1 * Block::Identity();
    }
  }

  std::vector<std::pair<int, int>> pairs;
  std::unique_ptr<BlockCholesky<N>> sparse;
  Eigen::MatrixXd dense;
};

TEST(BlockCholesky, SolvesAsTheDenseMatrixDoes) {
  std::mt19937 random(1);
  Springs<2> springs(random, 40, 100, 4);
  springs.sparse->factor();
  std::vector<Eigen::Vector2d> x(40);
  Eigen::VectorXd right(80);
  for (int i = 0; i < 40; ++i) {
    x[static_cast<std::size_t>(i)] = small_maps::random_point(random);
    right.segment<2>(2 * i) = x[static_cast<std::size_t>(i)];
  }
  springs.sparse->solve(x);
  const Eigen::VectorXd expected = springs.dense.ldlt().solve(right);
  for (int i = 0; i < 40; ++i)
    EXPECT_LT((x[static_cast<std::size_t>(i)] - expected.segment<2>(2 * i)).norm(), 1e-10);
}

TEST(BlockCholesky, SelectedInverseIsTheDiagonalOfTheDenseInverse) {
  std::mt19937 random(2);
  for (const int springs_count : {0, 30, 60, 300}) {
    Springs<3> springs(random, 40, springs_count, 6);
    springs.sparse->factor();
    EXPECT_TRUE(springs.sparse->positive_definite());
    const std::vector<Eigen::Matrix3d> selected = springs.sparse->inverse_diagonal();
    const Eigen::MatrixXd inverse = springs.dense.inverse();
    for (int i = 0; i < 40; ++i) {
      const Eigen::Matrix3d expected = inverse.block<3, 3>(3 * i, 3 * i);
      EXPECT_TRUE(selected[static_cast<std::size_t>(i)].isApprox(expected, 1e-9));
      EXPECT_TRUE(springs.sparse->inverse_diagonal(i).isApprox(expected, 1e-9));
    }
  }
}

TEST(BlockCholesky, AColumnOfTheInverseIsThatOfTheDenseInverse) {
  std::mt19937 random(5);
  for (const int springs_count : {0, 30, 300}) {
    Springs<3> springs(random, 40, springs_count, 6);
    springs.sparse->factor();
    const Eigen::MatrixXd inverse = springs.dense.inverse();
    for (const int j : {0, 17, 39}) {
      const std::vector<Eigen::Matrix3d> column = springs.sparse->inverse_column(j);
      ASSERT_EQ(column.size(), 40U);
      for (int i = 0; i < 40; ++i)
        EXPECT_TRUE((column[static_cast<std::size_t>(i)] - inverse.block<3, 3>(3 * i, 3 * j)).isZero(1e-9));
    }
  }
}

TEST(BlockCholesky, UsedAgainAfterClearIsAsNew) {
  std::mt19937 random(3);
  Springs<3> springs(random, 10, 20, 6);
  springs.sparse->factor();
  springs.sparse->clear();
  for (int i = 0; i < 10; ++i) springs.sparse->add_diagonal(i, 4 * Eigen::Matrix3d::Identity());
  springs.sparse->factor();
  for (const Eigen::Matrix3d& block : springs.sparse->inverse_diagonal())
    EXPECT_TRUE(block.isApprox(0.25 * Eigen::Matrix3d::Identity()));
}

TEST(BlockCholesky, DirectionsWithoutInformationGetAHugeVarianceAndNoMotion) {
  const std::vector<std::pair<int, int>> pairs{{0, 1}};
  BlockCholesky<2> matrix(2, pairs);
  // Row 0 is held in both directions, row 1 tied to it in the first only.
  const Eigen::Matrix2d first = Eigen::Vector2d(1, 0).asDiagonal();
  matrix.add_diagonal(0, first + Eigen::Matrix2d::Identity());
  matrix.add_diagonal(1, first);
  matrix.add(0, 1, -first);
  matrix.factor();
  EXPECT_FALSE(matrix.positive_definite());
  const std::vector<Eigen::Matrix2d> inverse = matrix.inverse_diagonal();
  EXPECT_TRUE(inverse[0].isApprox(Eigen::Matrix2d::Identity(), 1e-9));
  EXPECT_NEAR(inverse[1](0, 0), 2, 1e-9);
  EXPECT_GE(inverse[1](1, 1), 1e6);
  std::vector<Eigen::Vector2d> x{{1, 1}, {1, 0}};
  matrix.solve(x);
  EXPECT_NEAR(x[1].y(), 0, 1e-12);
  EXPECT_NEAR(x[1].x(), 3, 1e-9);
}

// Held along x by a million times less than along y is weak but known; by 1e-13, rounding.
TEST(BlockCholesky, PartsWeakInformationFromRounding) {
  for (const auto& [share, known] : {std::pair{1e-6, true}, {1e-9, true}, {1e-11, false}, {1e-13, false}}) {
    BlockCholesky<2> matrix(1, {});
    matrix.add_diagonal(0, 1e4 * Eigen::Vector2d(share, 1).asDiagonal().toDenseMatrix());
    matrix.factor();
    EXPECT_EQ(matrix.positive_definite(), known) << share;
    EXPECT_EQ(matrix.partly_deficient(), !known) << share;
    const Eigen::Matrix2d inverse = matrix.inverse_diagonal(0);
    EXPECT_NEAR(inverse(1, 1), 1e-4, 1e-10);
    const double variance = known ? 1e-4 / share : BlockCholesky<2>::undetermined_variance;
    EXPECT_NEAR(inverse(0, 0) / variance, 1, 1e-6) << share;
  }
}

// What elimination leaves of 1e4 less 1e4 is no information, though it is not exactly zero.
TEST(BlockCholesky, TakesWhatEliminationLeavesOverForNothing) {
  std::mt19937 random(5);
  for (int round = 0; round < 50; ++round) {
    // Two patches tied to one another and to nothing else: their common motion is free.
    const std::vector<std::pair<int, int>> pairs{{0, 1}};
    BlockCholesky<3> matrix(2, pairs);
    const Eigen::Matrix3d tie = 1e4 * small_maps::random_information(random);
    Eigen::Matrix3d moved = Eigen::Matrix3d::Identity();
    moved.topRightCorner<2, 1>() = small_maps::random_point(random);
    matrix.add_diagonal(0, tie);
    matrix.add_diagonal(1, moved.transpose() * tie * moved);
    matrix.add(0, 1, -tie * moved);
    matrix.factor();
    EXPECT_FALSE(matrix.positive_definite());
    EXPECT_GE(matrix.inverse_diagonal(0).diagonal().maxCoeff(),
              0.01 * BlockCholesky<3>::undetermined_variance);
  }
}

TEST(BlockCholesky, RefusesABlockOutsideThePattern) {
  const std::vector<std::pair<int, int>> pairs{{0, 1}};
  BlockCholesky<2> matrix(3, pairs);
  EXPECT_THROW(matrix.add(0, 2, Eigen::Matrix2d::Identity()), std::out_of_range);
}

}  // namespace
}  // namespace isthmus
