#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>

#include "server/feature_maps/merging/free_view.hpp"

namespace isthmus {

/// The ground that views see through, by cells; as large as what was seen, wherever that lies.
class FreeGround {
 public:
  explicit FreeGround(const MergingOptions& options);

  void add(const FreeView& view);
  /// Whether enough views see it free.
  bool is_free(const Eigen::Vector2d& place) const;

 private:
  static constexpr std::int64_t tile_cells = 32;
  struct Cell {
    std::int32_t last_view = 0;
    std::int32_t views = 0;
  };
  using Tile = std::array<Cell, tile_cells * tile_cells>;
  struct Address {
    std::uint64_t tile = 0;
    std::size_t cell = 0;
  };
  std::optional<Address> address_of(const Eigen::Vector2d& place) const;

  double cell_m_;
  double margin_m_;
  double reach_m_;
  int enough_;
  std::int32_t view_ = 0;
  std::unordered_map<std::uint64_t, Tile> tiles_;
};

}  // namespace isthmus
