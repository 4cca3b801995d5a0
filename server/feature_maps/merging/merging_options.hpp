#pragma once

#include <cstddef>

namespace isthmus {

/// Of what maps keep for finding one another, of the search, and of its account.
struct MergingOptions {
  double view_every_m =
      1;  ///< m and rad between the places that a view is kept of: one a place, however often
  double view_every_rad = 0.5;  ///< a robot comes by
  double view_reach_m = 8;      ///< m to which a view tells: farther off, a heading's error counts too much
  std::size_t view_sectors = 120;  ///< of the full turn: 0.4 m wide at the reach
  double free_cell_m = 0.25;
  double free_margin_m = 0.4;  ///< m short of what was hit that count as free: maps bend by as much
  int free_views = 2;          ///< that see a cell free: one may have been somewhere else

  std::size_t max_walls = 400;         ///< of a map, the longest: bounds the search
  std::size_t max_corners = 600;       ///< of a map, those of the longest walls
  double corner_reach_m = 1.5;         ///< m from either wall to where their lines cross
  double min_corner_rad = 0.35;        ///< rad between them
  double corner_tolerance_rad = 0.15;  ///< by which the angles of two corners may differ and be one
  double bin_m = 1;                    ///< of the vote for placings
  double bin_rad = 0.1;
  std::size_t max_peaks = 200;    ///< of the vote that are tried as they are,
  std::size_t max_placings = 48;  ///< and the best of these looked into
  double peak_m = 1;              ///< m by which walls may differ to begin with

  double twin_m = 0.35;  ///< m and rad by which two walls may differ and be one: maps bend
  double twin_rad = 0.12;
  double twin_overlap = 0.5;     ///< of the shorter one
  double log_odds_per_wall = 1;  ///< for a placing, of each wall that it explains,
  double log_odds_per_contradiction =
      2.5;                      ///< against it, of each that it puts where the other map saw through,
  double against_any = 11;      ///< and before: halves of a building that look alike explain 17
                                ///< walls and contradict none, until more of them is seen
  double rival_share = 0.5;     ///< of the walls that the best explains, from which a placing shows that the
                                ///< building repeats itself: then what it leaves unseen may be there too
  std::size_t min_across = 4;   ///< walls of either direction that are explained: a corridor has but its ends
  std::size_t min_beyond = 8;   ///< walls of either map beyond what they share: rooms and wings look alike,
  double beyond_share = 0.2;    ///< and this share of what is explained,
  std::size_t whole = 100;      ///< or so many explained: floors hardly look alike
  std::size_t min_views = 8;    ///< of either map, before they are laid over one another;
  std::size_t grown_views = 4;  ///< again when there are so many more,
  double grown_share = 0.1;     ///< and this share of all

  double same_m = 1;  ///< m and rad between two placings that are the same
  double same_rad = 0.1;
  double same_fusion =
      3;  ///< times these, by which a placing that was taken back may come again and be known
  double placing_sigma_m = 0.5;         ///< m that sightings may be off by a placing of walls
  double seed_m = 0.15;                 ///< m that twins may differ with which a fusion begins,
  std::size_t seeds_per_direction = 3;  ///< of either direction, where most are
  double min_free_m = 0.75;             ///< m of a wall that stand in the open, for it to contradict
  double before_wall_m = 0.6;           ///< m before a wall: who saw that free would have seen the wall
};

}  // namespace isthmus
