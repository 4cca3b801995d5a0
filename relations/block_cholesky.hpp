#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace isthmus {

/// A sparse symmetric positive semidefinite matrix A of N x N blocks, factored as P A Pᵀ = L D Lᵀ with unit L
/// and block-diagonal D, ordered by approximate minimum degree on the graph of blocks. One class serves the
/// Fisher information (N = 3) and the chordal start (N = 2).
///
/// Directions without information are met as null directions of a pivot block. The factorisation goes on with
/// the pivot's pseudo-inverse, which is exact for a semidefinite matrix; such directions then stay at zero in
/// `solve` and get the variance `undetermined_variance` in `inverse_diagonal`. They are carried apart from
/// the finite variances: a huge number among them would cost the determined rows their last digits.
template <int N>
class BlockCholesky {
 public:
  using Block = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  static constexpr double undetermined_variance = 1e8;

  /// All zero, of `size` block rows; `pairs` are the off-diagonal blocks that may differ from zero (any
  /// order, repetitions allowed).
  BlockCholesky(int size, std::span<const std::pair<int, int>> pairs);

  /// Back to all zero, the pattern and its order kept.
  void clear();
  /// A_ii += block.
  void add_diagonal(int i, const Block& block) { pivot_[at(order_[at(i)])] += block; }
  /// A_ij += block and A_ji += blockᵀ, for one of the pairs given.
  void add(int i, int j, const Block& block);

  /// Replaces A by its factor, once.
  void factor();
  /// Whether every pivot was of full rank.
  bool positive_definite() const { return null_projector_.empty(); }
  /// Whether some pivot lacked some directions but not all: a block row that is free along a line, say.
  bool partly_deficient() const { return partly_deficient_; }

  /// A⁻¹ x in place, one N-vector a block row.
  void solve(std::span<Vector> x) const;

  /// The diagonal blocks of A⁻¹ by Takahashi's recursion over the pattern of L alone (Takahashi, Fagan and
  /// Chen 1973; Erisman and Tinney 1975).
  std::vector<Block> inverse_diagonal() const;

  /// The blocks of one block column of A⁻¹, by row.
  std::vector<Block> inverse_column(int j) const;

  /// One diagonal block of A⁻¹, by a forward solve along its elimination path.
  Block inverse_diagonal(int i) const;

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  void find_order(int size, std::span<const std::pair<int, int>> pairs);
  void find_pattern(int size, std::span<const std::pair<int, int>> pairs);
  void invert_pivot(int column);
  std::size_t find(int row, int column) const;
  /// A⁻¹ y in place, in elimination order.
  template <class Rows>
  void solve_in_order(std::vector<Rows>& y) const;
  void selected_inverse(std::vector<Block>& diagonal) const;
  static Block with_undetermined(const Block& covariance, const Block& null_share);

  // In elimination order: column c of L has the rows row_[begin_[c] .. begin_[c + 1]), ascending, below c.
  std::vector<int> order_;  ///< place in the elimination order, by block row of A
  std::vector<std::size_t> begin_;
  std::vector<int> row_;
  std::vector<Block> lower_;
  std::vector<Block> pivot_;                           ///< D
  std::vector<Block> pivot_inverse_;                   ///< D⁺
  std::vector<std::pair<int, Block>> null_projector_;  ///< n nᵀ of the deficient pivots, by column
  std::vector<double> scale_;                          ///< largest diagonal entry before elimination
  bool partly_deficient_ = false;
};

extern template class BlockCholesky<2>;
extern template class BlockCholesky<3>;

}  // namespace isthmus
