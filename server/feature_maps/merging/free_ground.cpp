#include "server/feature_maps/merging/free_ground.hpp"

#include <cmath>
#include <numbers>

namespace isthmus {

FreeGround::FreeGround(const MergingOptions& options)
    : cell_m_(options.free_cell_m),
      margin_m_(options.free_margin_m),
      reach_m_(options.view_reach_m),
      enough_(options.free_views) {}

std::optional<FreeGround::Address> FreeGround::address_of(const Eigen::Vector2d& place) const {
  constexpr double farthest_m = 1e6;
  if (!(std::abs(place.x()) < farthest_m && std::abs(place.y()) < farthest_m)) return std::nullopt;
  const auto cell = [&](double at) { return static_cast<std::int64_t>(std::floor(at / cell_m_)); };
  const std::int64_t x = cell(place.x()), y = cell(place.y());
  const auto tile = [](std::int64_t at) { return (at >= 0 ? at : at - tile_cells + 1) / tile_cells; };
  const std::int64_t tile_x = tile(x), tile_y = tile(y);
  return Address{static_cast<std::uint64_t>(tile_x) << 32 | (static_cast<std::uint64_t>(tile_y) & 0xffffffff),
                 static_cast<std::size_t>((y - tile_y * tile_cells) * tile_cells + x - tile_x * tile_cells)};
}

void FreeGround::add(const FreeView& view) {
  ++view_;
  const double width = 2 * std::numbers::pi / static_cast<double>(view.hit_m.size());
  for (std::size_t i = 0; i < view.hit_m.size(); ++i) {
    const double free_m = std::min<double>(view.hit_m[i], reach_m_) - margin_m_;
    const Eigen::Vector2d ray =
        rotate(view.map_from_laser.yaw + (static_cast<double>(i) + 0.5) * width, {1, 0});
    for (double at = 0; at < free_m; at += 0.8 * cell_m_) {
      const std::optional<Address> address = address_of(position(view.map_from_laser) + at * ray);
      if (!address) continue;
      Cell& cell = tiles_[address->tile][address->cell];
      if (cell.last_view == view_) continue;
      cell.last_view = view_;
      ++cell.views;
    }
  }
}

bool FreeGround::is_free(const Eigen::Vector2d& place) const {
  const std::optional<Address> address = address_of(place);
  if (!address) return false;
  const auto tile = tiles_.find(address->tile);
  return tile != tiles_.end() && tile->second[address->cell].views >= enough_;
}

}  // namespace isthmus
