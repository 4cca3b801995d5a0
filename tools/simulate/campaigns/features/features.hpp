#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "server/features/feature_filter.hpp"
#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

/// What a map by segments is worth at one time, and the way of its robot till then.
struct FeatureColumn {
  double position_m = 0;       ///< mean absolute error over the way
  double orientation_deg = 0;  ///< the same
  double nees = 0;             ///< NEES/3, mean over the way
  double alpha_deg = 0;        ///< mean absolute error of the lines' direction
  double rho_m = 0;            ///< and of their distance from the frame's origin
  double middle_m = 0;         ///< how far the walls' middles are from the true surface's line
  double endpoint_m = 0;       ///< of known ends, to the nearest true end or corner
  double features = 0;
  double endpoints = 0;
  double matched = 0;  ///< features that lie on a true wall; α, ρ and middles are of those
  double cpu_s = 0;
};

/// Benedettelli et al. 2012, tables 2 and 3: robots alone, together (each in its own frame), and together at
/// half time.
enum class FeatureColumnId { s1, s2, m1, m2, mh1, mh2 };
constexpr std::array<const char*, 6> feature_column_names = {"S1", "S2", "M1", "M2", "MH1", "MH2"};

struct FeatureTrial {
  std::array<std::optional<FeatureColumn>, 6> columns;  ///< none for M and MH where the robots never met
  std::optional<double> met_s;                          ///< time of the run of the rendezvous
  std::size_t duplicates = 0;  ///< found in the fusion of the second map into the first
};

struct FeatureCampaignOptions {
  FilterForm form = FilterForm::invariant;
  Pairing pairing = Pairing::joint;
  double surface_sigma_m = 0.004;  ///< m: the walls' roughness, as the robots are told
  double observe_every_m = 0.3;  ///< m driven between scans that are used: consecutive ones tell little more
  double observe_every_rad = 0.2;      ///< rad turned
  std::optional<double> meet_after_s;  ///< of the run: when they are told where the other is, wherever they
                                       ///< are; none: when one first sees the other
};

/// One seed: maps the first two robots of a run by segments, alone, and joined at their first rendezvous;
/// `plan` is what they were in. Robots' frames are where they started.
FeatureTrial try_features(const SimulatedRun& run, const FloorPlan& plan, std::uint64_t seed,
                          const FeatureCampaignOptions& options);

/// Means over the trials that have a column.
FeatureColumn mean_of(const std::vector<FeatureTrial>& trials, FeatureColumnId column);

/// Errors of a robot's walls against the plan, told in the robot's frame; adds to the column.
void judge_walls(const FeatureState& state, const FloorPlan& plan, const Pose& world_from_map,
                 FeatureColumn& column);

}  // namespace isthmus
