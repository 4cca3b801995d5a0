#include "server/paths/roadmap.hpp"

#include <algorithm>
#include <cstdlib>
#include <numbers>
#include <utility>

namespace isthmus {
namespace {

constexpr std::int32_t side_cells = 4;
/// Where a robot has driven, the unseen is nowhere nearer than that.
constexpr double max_from_unseen_m = stood_m - ground_cell_m;
constexpr SquareId none = -1;
constexpr SquareId free = -2;  // of no square yet

bool in_one_square(const Cell& a, const Cell& b) {
  const auto part = [](std::int32_t cell) { return cell & ~(side_cells - 1); };
  return part(a.x) == part(b.x) && part(a.y) == part(b.y);
}

}  // namespace

Roadmap::Roadmap(std::shared_ptr<const Ground> ground, const Footprint& footprint)
    : ground_(std::move(ground)), footprint_(footprint) {
  find_squares(footprint);
  find_beside();
}

void Roadmap::find_squares(const Footprint& footprint) {
  // A straight way through a cell passes its centre by half its diagonal at most.
  constexpr double off_centre_m = 0.5 * std::numbers::sqrt2 * ground_cell_m;
  const auto from_walls = static_cast<float>(footprint.radius_m + footprint.clearance_m + off_centre_m);
  const auto from_unseen = static_cast<float>(std::min(footprint.radius_m, max_from_unseen_m));
  for (NodeId node = 0; node < static_cast<NodeId>(ground_->size()); ++node) {
    const bool fits = !ground_->layer(node).occupied && ground_->wall_m(node) >= from_walls &&
                      ground_->unseen_m(node) >= from_unseen;
    square_.push_back(fits ? free : none);
  }
  for (NodeId node = 0; node < static_cast<NodeId>(ground_->size()); ++node)
    if (square_[static_cast<std::size_t>(node)] == free) flood(node);
}

void Roadmap::flood(NodeId start) {
  const auto square = static_cast<SquareId>(middle_.size());
  std::vector<NodeId> members{start};
  square_[static_cast<std::size_t>(start)] = square;
  for (std::size_t i = 0; i < members.size(); ++i) {
    visit_beside(ground_->cell(members[i]), [&](const Cell& beside) {
      if (!in_one_square(ground_->cell(start), beside)) return;
      const NodeId next = ground_->step(members[i], beside);
      if (next < 0 || square_[static_cast<std::size_t>(next)] != free) return;
      square_[static_cast<std::size_t>(next)] = square;
      members.push_back(next);
    });
  }
  middle_.push_back(*std::max_element(members.begin(), members.end(), [this](NodeId a, NodeId b) {
    return ground_->wall_m(a) < ground_->wall_m(b);
  }));
}

void Roadmap::find_beside() {
  std::vector<std::pair<SquareId, SquareId>> pairs;
  for (NodeId node = 0; node < static_cast<NodeId>(ground_->size()); ++node) {
    if (!fits(node)) continue;
    visit_beside(ground_->cell(node), [&](const Cell& beside) {
      if (in_one_square(ground_->cell(node), beside)) return;
      const NodeId next = ground_->step(node, beside);
      if (next < 0 || !fits(next)) return;
      pairs.emplace_back(square(node), square(next));
      pairs.emplace_back(square(next), square(node));
    });
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  beside_.reserve(pairs.size());
  for (const auto& [from, to] : pairs) {
    first_beside_.resize(static_cast<std::size_t>(from) + 1, static_cast<std::uint32_t>(beside_.size()));
    beside_.push_back(to);
  }
  first_beside_.resize(middle_.size() + 1, static_cast<std::uint32_t>(beside_.size()));
}

std::optional<NodeId> Roadmap::straight(NodeId from, const Cell& to) const {
  Cell at = ground_->cell(from);
  const int width = std::abs(to.x - at.x), height = std::abs(to.y - at.y);
  const int right = to.x > at.x ? 1 : -1, up = to.y > at.y ? 1 : -1;
  NodeId node = from;
  // Of the sides of the cells that the line crosses: which comes next, in halves of a cell.
  for (int ix = 0, iy = 0; ix < width || iy < height;) {
    const auto next_x = static_cast<std::int64_t>(1 + 2 * ix) * height;
    const auto next_y = static_cast<std::int64_t>(1 + 2 * iy) * width;
    if (next_x <= next_y) {
      at.x += right;
      ++ix;
    }
    if (next_y <= next_x) {
      at.y += up;
      ++iy;
    }
    node = ground_->step(node, at);
    if (node < 0 || !fits(node)) return std::nullopt;
  }
  return node;
}

}  // namespace isthmus
