#pragma once

#include <cstddef>

namespace isthmus {

/// How the filter handles errors.
enum class FilterForm {
  /// Right-invariant on SE_{1+L}(2) (Barrau and Bonnabel, arXiv 1510.06263): gains nothing about the global
  /// heading,
  /// which nobody measures.
  invariant,
  /// The EKF as printed (Zhou and Roumeliotis 2006; Benedettelli et al. 2012): overconfident (Huang, Mourikis
  /// and
  /// Roumeliotis, IJRR 2010); for comparison.
  printed
};

enum class Pairing {
  joint,   ///< the largest set that is compatible as a whole (JCBB, Neira and Tardos 2001)
  nearest  ///< each observation by itself, to the nearest by Mahalanobis distance (Benedettelli et al.
           ///< 2012, 3.1)
};

struct AssociationOptions {
  Pairing pairing = Pairing::joint;
  double probability = 0.99;    ///< that a true pairing passes a gate, and a true set the joint one
  double min_overlap = 0.2;     ///< of the shorter segment's length (τ): below, they are two walls in a row
  double free_end_reach_m = 1;  ///< m that a wall may go on beyond an end that was not seen: a door's width
  double end_slack_m = 0.3;     ///< m that an end may be seen short of how far the wall was seen already
  double opening_tolerance_rad =
      0.5;  ///< rad between a corner's angle and the map's: a wall more or less is 1.6
  std::size_t max_steps =
      20'000;  ///< of the search; then the best set so far holds, so that clutter is bounded
};

struct TentativeOptions {
  int confirm_after = 3;  ///< sightings before a feature enters the state: clutter is rarely seen thrice
  int forget_after = 10;  ///< scans without a sighting
  double position_slack_m =
      0.1;  ///< m and rad that the robot may have drifted against the list in so many scans
  double angle_slack_rad = 0.05;
  std::size_t max_entries = 500;  ///< entries; the oldest goes
};

struct SeenThroughOptions {
  int drop_after = 5;          ///< scans that see through a feature: fewer are people's legs and glass
  double share_of_seen = 0.5;  ///< and this share of the times it was seen
};

struct FilterOptions {
  FilterForm form = FilterForm::invariant;
  AssociationOptions association;
  TentativeOptions tentative;
  SeenThroughOptions contradiction;
  std::size_t max_features = 5'000;  ///< of a map; further ones are counted
  /// Features nearest to each robot that a step corrects at once, beside those that are seen; the others wait
  /// (server/features/state/aside.hpp). It decides what a step costs, not what it tells.
  std::size_t at_hand = 30;
};

}  // namespace isthmus
