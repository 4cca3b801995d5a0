#include "relations/block_cholesky.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <stdexcept>

namespace isthmus {
namespace {

/// A pivot's eigenvalue below this share of what stood on its diagonal before elimination is rounding.
constexpr double pivot_tolerance = 1e-10;

}  // namespace

template <int N>
BlockCholesky<N>::BlockCholesky(int size, std::span<const std::pair<int, int>> pairs) {
  find_order(size, pairs);
  find_pattern(size, pairs);
  pivot_.resize(at(size));
  clear();
}

template <int N>
void BlockCholesky<N>::clear() {
  lower_.assign(row_.size(), Block::Zero());
  pivot_.assign(pivot_.size(), Block::Zero());
  null_projector_.clear();
  partly_deficient_ = false;
}

template <int N>
void BlockCholesky<N>::find_order(int size, std::span<const std::pair<int, int>> pairs) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * pairs.size() + at(size));
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, 1.0);
  for (const auto& [i, j] : pairs) {
    entries.emplace_back(i, j, 1.0);
    entries.emplace_back(j, i, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(size, size);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> elimination;
  Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), elimination);
  order_.resize(at(size));
  for (int place = 0; place < size; ++place) order_[at(elimination.indices()[place])] = place;
}

/// The pattern of a column of L: its own rows in A and those of its children in the elimination tree.
template <int N>
void BlockCholesky<N>::find_pattern(int size, std::span<const std::pair<int, int>> pairs) {
  std::vector<std::vector<int>> below(at(size));
  for (const auto& [i, j] : pairs) {
    const auto [column, row] = std::minmax({order_[at(i)], order_[at(j)]});
    below[at(column)].push_back(row);
  }
  std::vector<std::vector<int>> children(at(size));
  begin_.assign(1, 0);
  for (int column = 0; column < size; ++column) {
    std::vector<int>& rows = below[at(column)];
    for (const int child : children[at(column)]) {
      const auto first =
          row_.begin() + static_cast<std::ptrdiff_t>(begin_[at(child)]) + 1;  // past this column
      rows.insert(rows.end(), first, row_.begin() + static_cast<std::ptrdiff_t>(begin_[at(child) + 1]));
    }
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    if (!rows.empty()) children[at(rows.front())].push_back(column);
    row_.insert(row_.end(), rows.begin(), rows.end());
    begin_.push_back(row_.size());
  }
}

template <int N>
std::size_t BlockCholesky<N>::find(int row, int column) const {
  const auto first = row_.begin() + static_cast<std::ptrdiff_t>(begin_[at(column)]);
  const auto last = row_.begin() + static_cast<std::ptrdiff_t>(begin_[at(column) + 1]);
  const auto found = std::lower_bound(first, last, row);
  if (found == last || *found != row) throw std::out_of_range("block outside the pattern");
  return static_cast<std::size_t>(found - row_.begin());
}

template <int N>
void BlockCholesky<N>::add(int i, int j, const Block& block) {
  const int place_i = order_[at(i)];
  const int place_j = order_[at(j)];
  if (place_i > place_j)
    lower_[find(place_i, place_j)] += block;
  else
    lower_[find(place_j, place_i)] += block.transpose();
}

template <int N>
void BlockCholesky<N>::invert_pivot(int column) {
  const Block& pivot = pivot_[at(column)];
  const double least = pivot_tolerance * scale_[at(column)];
  const Eigen::LLT<Block> cholesky(pivot);
  const auto diagonal = cholesky.matrixLLT().diagonal();
  if (cholesky.info() == Eigen::Success && diagonal.cwiseAbs2().minCoeff() > least) {
    pivot_inverse_[at(column)] = cholesky.solve(Block::Identity());
    return;
  }
  const Eigen::SelfAdjointEigenSolver<Block> eigen(pivot);
  Vector inverse = Vector::Zero();
  Block projector = Block::Zero();
  for (int k = 0; k < N; ++k) {
    const Vector direction = eigen.eigenvectors().col(k);
    if (eigen.eigenvalues()(k) > least)
      inverse(k) = 1 / eigen.eigenvalues()(k);
    else
      projector += direction * direction.transpose();
  }
  pivot_inverse_[at(column)] = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
  if (projector.isZero(0)) return;
  null_projector_.emplace_back(column, projector);
  partly_deficient_ = partly_deficient_ || inverse.maxCoeff() > 0;
}

template <int N>
void BlockCholesky<N>::factor() {
  const int size = static_cast<int>(pivot_.size());
  scale_.resize(at(size));
  for (std::size_t c = 0; c < scale_.size(); ++c) scale_[c] = pivot_[c].diagonal().maxCoeff();
  pivot_inverse_.resize(at(size));
  std::vector<Block> scaled;  // L's column; lower_ holds L D until the updates are made
  for (int column = 0; column < size; ++column) {
    invert_pivot(column);
    const std::size_t begin = begin_[at(column)];
    const std::size_t end = begin_[at(column) + 1];
    scaled.clear();
    for (std::size_t k = begin; k < end; ++k) scaled.push_back(lower_[k] * pivot_inverse_[at(column)]);
    for (std::size_t k = begin; k < end; ++k) {
      const int target = row_[k];
      const Block transposed = scaled[k - begin].transpose();
      pivot_[at(target)].noalias() -= lower_[k] * transposed;
      std::size_t place = begin_[at(target)];
      for (std::size_t m = k + 1; m < end; ++m) {
        while (row_[place] != row_[m]) ++place;
        lower_[place].noalias() -= lower_[m] * transposed;
      }
    }
    std::copy(scaled.begin(), scaled.end(), lower_.begin() + static_cast<std::ptrdiff_t>(begin));
  }
}

template <int N>
template <class Rows>
void BlockCholesky<N>::solve_in_order(std::vector<Rows>& y) const {
  const int size = static_cast<int>(pivot_.size());
  for (int c = 0; c < size; ++c)
    for (std::size_t k = begin_[at(c)]; k < begin_[at(c) + 1]; ++k)
      y[at(row_[k])].noalias() -= lower_[k] * y[at(c)];
  for (int c = size - 1; c >= 0; --c) {
    y[at(c)] = pivot_inverse_[at(c)] * y[at(c)];
    for (std::size_t k = begin_[at(c)]; k < begin_[at(c) + 1]; ++k)
      y[at(c)].noalias() -= lower_[k].transpose() * y[at(row_[k])];
  }
}

template <int N>
void BlockCholesky<N>::solve(std::span<Vector> x) const {
  std::vector<Vector> y(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) y[at(order_[i])] = x[i];
  solve_in_order(y);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = y[at(order_[i])];
}

template <int N>
std::vector<typename BlockCholesky<N>::Block> BlockCholesky<N>::inverse_column(int j) const {
  std::vector<Block> y(pivot_.size(), Block::Zero());
  y[at(order_[at(j)])].setIdentity();
  solve_in_order(y);
  std::vector<Block> by_row(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) by_row[i] = y[at(order_[i])];
  return by_row;
}

/// Lᵀ⁻¹ diag(diagonal) L⁻¹, its diagonal blocks in place.
template <int N>
void BlockCholesky<N>::selected_inverse(std::vector<Block>& diagonal) const {
  // Z_ij = −Σ_k Z_ik L_kj over k in the column's pattern; every Z_ik needed lies in the pattern.
  std::vector<Block> z(row_.size());
  for (int column = static_cast<int>(pivot_.size()) - 1; column >= 0; --column) {
    const std::size_t begin = begin_[at(column)];
    const std::size_t end = begin_[at(column) + 1];
    for (std::size_t k = begin; k < end; ++k) z[k].setZero();
    for (std::size_t k = begin; k < end; ++k) {
      const int inner = row_[k];
      z[k].noalias() -= diagonal[at(inner)] * lower_[k];
      std::size_t place = begin_[at(inner)];
      for (std::size_t m = k + 1; m < end; ++m) {
        while (row_[place] != row_[m]) ++place;
        z[m].noalias() -= z[place] * lower_[k];
        z[k].noalias() -= z[place].transpose() * lower_[m];
      }
    }
    Block& own = diagonal[at(column)];
    for (std::size_t k = begin; k < end; ++k) own.noalias() -= lower_[k].transpose() * z[k];
    own = (0.5 * (own + own.transpose())).eval();
  }
}

/// A row without a share in any null direction (beyond rounding) keeps its covariance to the last digit.
template <int N>
typename BlockCholesky<N>::Block BlockCholesky<N>::with_undetermined(const Block& covariance,
                                                                     const Block& null_share) {
  const double share = null_share.trace();
  if (share <= pivot_tolerance) return covariance;
  return covariance + undetermined_variance / share * null_share;
}

template <int N>
std::vector<typename BlockCholesky<N>::Block> BlockCholesky<N>::inverse_diagonal() const {
  std::vector<Block> diagonal = pivot_inverse_;
  selected_inverse(diagonal);
  if (!positive_definite()) {
    std::vector<Block> null_share(diagonal.size(), Block::Zero());
    for (const auto& [column, projector] : null_projector_) null_share[at(column)] = projector;
    selected_inverse(null_share);
    for (std::size_t c = 0; c < diagonal.size(); ++c)
      diagonal[c] = with_undetermined(diagonal[c], null_share[c]);
  }
  std::vector<Block> by_row(diagonal.size());
  for (std::size_t i = 0; i < by_row.size(); ++i) by_row[i] = diagonal[at(order_[i])];
  return by_row;
}

template <int N>
typename BlockCholesky<N>::Block BlockCholesky<N>::inverse_diagonal(int i) const {
  std::vector<Block> y(pivot_.size(), Block::Zero());
  int column = order_[at(i)];
  y[at(column)].setIdentity();
  Block result = Block::Zero();
  Block null_share = Block::Zero();
  while (true) {
    const Block& here = y[at(column)];
    result.noalias() += here.transpose() * pivot_inverse_[at(column)] * here;
    for (const auto& [deficient, projector] : null_projector_)
      if (deficient == column) null_share += here.transpose() * projector * here;
    const std::size_t begin = begin_[at(column)];
    const std::size_t end = begin_[at(column) + 1];
    if (begin == end) break;
    for (std::size_t k = begin; k < end; ++k) y[at(row_[k])].noalias() -= lower_[k] * here;
    column = row_[begin];  // the parent in the elimination tree
  }
  return with_undetermined(result, null_share);
}

template class BlockCholesky<2>;
template class BlockCholesky<3>;

}  // namespace isthmus
