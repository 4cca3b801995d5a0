#include "server/paths/questions/frontiers.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "server/paths/roads/route.hpp"

namespace isthmus {
namespace {

std::size_t index(NodeId node) { return static_cast<std::size_t>(node); }

/// The cells of each frontier.
std::vector<std::vector<NodeId>> clusters(const Ground& ground) {
  std::vector<std::uint8_t> open(ground.size());
  for (NodeId node = 0; node < static_cast<NodeId>(ground.size()); ++node)
    open[index(node)] = !ground.layer(node).occupied && ground.borders_on_unseen(node);
  std::vector<std::vector<NodeId>> found;
  for (NodeId node = 0; node < static_cast<NodeId>(ground.size()); ++node) {
    if (!std::exchange(open[index(node)], 0)) continue;
    std::vector<NodeId> members{node};
    for (std::size_t i = 0; i < members.size(); ++i) {
      visit_beside(ground.cell(members[i]), [&](const Cell& beside) {
        const NodeId next = ground.step(members[i], beside);
        if (next >= 0 && std::exchange(open[index(next)], 0)) members.push_back(next);
      });
    }
    found.push_back(std::move(members));
  }
  return found;
}

double size_m(const Ground& ground, const std::vector<NodeId>& members) {
  Cell low = ground.cell(members.front()), high = low;
  for (const NodeId node : members) {
    const Cell& cell = ground.cell(node);
    low = {std::min(low.x, cell.x), std::min(low.y, cell.y)};
    high = {std::max(high.x, cell.x), std::max(high.y, cell.y)};
  }
  return ground_cell_m * std::hypot(high.x - low.x + 1, high.y - low.y + 1);
}

/// Cuts what is longer across its longest direction, at its middle, until nothing is (Zhou et al. 2021).
void cut(const Ground& ground, std::vector<NodeId> members, double max_size_m,
         std::vector<std::vector<NodeId>>& pieces) {
  if (size_m(ground, members) <= max_size_m) {
    pieces.push_back(std::move(members));
    return;
  }
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const NodeId node : members) middle += ground.centre(node) / static_cast<double>(members.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const NodeId node : members) {
    const Eigen::Vector2d away = ground.centre(node) - middle;
    spread += away * away.transpose();
  }
  const Eigen::Vector2d along = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvectors().col(1);
  const auto second = std::stable_partition(members.begin(), members.end(), [&](NodeId node) {
    return along.dot(ground.centre(node) - middle) < 0;
  });
  cut(ground, {members.begin(), second}, max_size_m, pieces);
  cut(ground, {second, members.end()}, max_size_m, pieces);
}

Frontier frontier_of(const Ground& ground, const std::vector<NodeId>& members) {
  Frontier frontier;
  for (const NodeId node : members) frontier.middle += ground.centre(node);
  frontier.middle /= static_cast<double>(members.size());
  frontier.node = *std::min_element(members.begin(), members.end(), [&](NodeId a, NodeId b) {
    return (ground.centre(a) - frontier.middle).squaredNorm() <
           (ground.centre(b) - frontier.middle).squaredNorm();
  });
  frontier.size_m = size_m(ground, members);
  return frontier;
}

/// The cell near the frontier, and not behind anything, to which the way is shortest. Cells are reached from
/// the frontier over free ground.
void find_viewpoint(const Roadmap& roadmap, const std::vector<NodeId>& members,
                    const std::vector<float>& costs, const FrontierOptions& options,
                    std::vector<std::int32_t>& reached, std::int32_t mark, Frontier& frontier) {
  const Ground& ground = roadmap.ground();
  std::vector<NodeId> wave = members;
  for (const NodeId node : wave) reached[index(node)] = mark;
  frontier.cost_m = std::numeric_limits<double>::infinity();
  const int steps = static_cast<int>(options.reach_m / ground_cell_m);
  for (int step = 0; step < steps && !wave.empty(); ++step) {
    std::vector<NodeId> next_wave;
    for (const NodeId node : wave) {
      if (roadmap.fits(node)) {
        const double cost = step * ground_cell_m +
                            (costs.empty() ? 0 : costs[static_cast<std::size_t>(roadmap.square(node))]);
        if (cost < frontier.cost_m) {
          frontier.cost_m = cost;
          frontier.viewpoint = node;
        }
      }
      visit_beside(ground.cell(node), [&](const Cell& beside) {
        const NodeId next = ground.step(node, beside);
        if (next < 0 || ground.layer(next).occupied || reached[index(next)] == mark) return;
        reached[index(next)] = mark;
        next_wave.push_back(next);
      });
    }
    if (options.close_up && frontier.viewpoint >= 0) return;
    wave = std::move(next_wave);
  }
}

/// Rays from a cell: over free ground and the unseen until something occupied.
double gain_m2(const Ground& ground, NodeId from, double view_m) {
  constexpr int rays = 180;
  double gain = 0;
  for (int ray = 0; ray < rays; ++ray) {
    const double angle = 2 * std::numbers::pi * ray / rays;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    PatchId leader = ground.layer(from).leader;
    for (double range = ground_cell_m; range <= view_m; range += ground_cell_m) {
      const NodeId node = ground.find(cell_of(ground.centre(from) + direction * range), leader);
      if (node >= 0 && ground.layer(node).occupied) break;
      if (node >= 0)
        leader = ground.layer(node).leader;
      else
        gain += range * ground_cell_m * (2 * std::numbers::pi / rays);
    }
  }
  return gain;
}

}  // namespace

std::vector<Frontier> find_frontiers(const Roadmap& roadmap, NodeId from, const FrontierOptions& options) {
  const Ground& ground = roadmap.ground();
  const std::vector<float> costs = from >= 0 ? costs_from(roadmap, from) : std::vector<float>{};
  std::vector<std::int32_t> reached(ground.size(), -1);
  const double min_size_m = 2 * roadmap.footprint().radius_m * options.min_size_diameters;
  std::vector<std::vector<NodeId>> pieces;
  for (std::vector<NodeId>& members : clusters(ground))
    if (size_m(ground, members) >= min_size_m) cut(ground, std::move(members), options.max_size_m, pieces);
  std::vector<Frontier> found;
  std::int32_t mark = 0;
  for (const std::vector<NodeId>& members : pieces) {
    Frontier frontier = frontier_of(ground, members);
    find_viewpoint(roadmap, members, costs, options, reached, mark++, frontier);
    frontier.gain_m2 =
        gain_m2(ground, frontier.viewpoint >= 0 ? frontier.viewpoint : frontier.node, options.view_m);
    if (frontier.gain_m2 >= options.min_gain_m2) found.push_back(frontier);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Frontier& a, const Frontier& b) { return a.gain_m2 > b.gain_m2; });
  return found;
}

}  // namespace isthmus
