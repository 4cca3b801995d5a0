#include "server/paths/roads/roadmap.hpp"

#include <algorithm>
#include <numbers>
#include <utility>

#include "server/paths/ground/cell_line.hpp"

namespace isthmus {
namespace {

constexpr std::int32_t square_side_cells = 4;
/// Where a robot has driven, the unseen is nowhere nearer than that.
constexpr double max_from_unseen_m = stood_m - ground_cell_m;
/// A straight way through a cell passes its centre by half its diagonal at most.
constexpr double off_centre_m = 0.5 * std::numbers::sqrt2 * ground_cell_m;
constexpr SquareId none = -1;
constexpr SquareId free = -2;  // of no square yet

bool in_one_square(const Cell& a, const Cell& b) {
  const auto part = [](std::int32_t cell) { return cell & ~(square_side_cells - 1); };
  return part(a.x) == part(b.x) && part(a.y) == part(b.y);
}

}  // namespace

Roadmap::Roadmap(std::shared_ptr<const Ground> ground, const Footprint& footprint,
                 std::span<const Zone> zones)
    : ground_(std::move(ground)), footprint_(footprint) {
  // A fit may move a zone by so much before a roadmap is made again (`are_alike`).
  constexpr double moved_m = 0.5 * ground_cell_m;
  find_squares(footprint, KeptOutCells(zones, footprint.radius_m + off_centre_m + moved_m));
  find_beside();
  find_open();
}

void Roadmap::find_squares(const Footprint& footprint, const KeptOutCells& kept_out) {
  const auto from_walls = static_cast<float>(footprint.radius_m + footprint.clearance_m + off_centre_m);
  const auto from_unseen = static_cast<float>(std::min(footprint.radius_m, max_from_unseen_m));
  for (NodeId node = 0; node < static_cast<NodeId>(ground_->size()); ++node) {
    const bool fits = !ground_->layer(node).occupied && ground_->wall_m(node) >= from_walls &&
                      ground_->unseen_m(node) >= from_unseen && !kept_out.contains(ground_->cell(node));
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
  std::vector<Cell> middles;
  std::vector<Eigen::Vector2d> points_m;
  for (const NodeId middle : middle_) {
    middles.push_back(ground_->cell(middle));
    points_m.push_back(ground_->centre(middle));
  }
  graph_ = PointGraph(std::move(points_m), pairs);
  regions_ = Regions(middles, graph_);
}

/// Whether stepping from a cell to any of the eight beside it comes to the only layer there is, on which the
/// footprint fits.
bool Roadmap::is_open(NodeId node) const {
  if (!fits(node) || ground_->only(ground_->cell(node)) != node) return false;
  bool open = true;
  visit_beside(ground_->cell(node), [&](const Cell& beside) {
    const NodeId next = ground_->only(beside);
    open = open && next >= 0 && fits(next) && ground_->step(node, beside) == next;
  });
  return open;
}

/// From where something is near outwards, ring by ring.
void Roadmap::find_open() {
  constexpr std::uint8_t unreached = 255;
  open_.assign(ground_->size(), unreached);
  std::vector<NodeId> wave;
  for (NodeId node = 0; node < static_cast<NodeId>(ground_->size()); ++node) {
    if (is_open(node)) continue;
    open_[static_cast<std::size_t>(node)] = 0;
    wave.push_back(node);
  }
  for (std::uint8_t ring = 1; ring < unreached && !wave.empty(); ++ring) {
    std::vector<NodeId> next_wave;
    for (const NodeId node : wave) {
      visit_beside(ground_->cell(node), [&](const Cell& beside) {
        const NodeId next = ground_->only(beside);
        if (next < 0 || open_[static_cast<std::size_t>(next)] != unreached) return;
        open_[static_cast<std::size_t>(next)] = ring;
        next_wave.push_back(next);
      });
    }
    wave = std::move(next_wave);
  }
}

std::optional<NodeId> Roadmap::straight(NodeId from, const Cell& to) const {
  CellLine line(ground_->cell(from), to);
  NodeId node = from;
  while (!line.done()) {
    const std::int32_t open = open_cells(node);
    if (open > 1) {
      node = ground_->only(line.leap(open));
    } else {
      node = ground_->step(node, line.step());
      if (node < 0 || !fits(node)) return std::nullopt;
    }
  }
  return node;
}

}  // namespace isthmus
