#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/paths/questions/planner.hpp"

namespace isthmus {

struct CoordinationOptions {
  double speed_mps = 0.5;   ///< at which robots are taken to drive
  double horizon_s = 24;    ///< so far ahead robots hold the ways that they drive
  double margin_m = 0.15;   ///< between the outlines of two robots
  double aside_m = 0.15;    ///< more of it where one stands aside
  double early_s = 0.7;     ///< a robot may come so much earlier or later than it is taken to
  double detour_m = 4;      ///< a way longer by this is driven rather than waited for another
  double max_aside_m = 30;  ///< to where a robot stands aside
  /// Of a roadmap, by all searches for ways: when they have looked at so many, no other order of rights is
  /// tried, and who is stuck waits. A square takes about a microsecond.
  std::size_t max_squares = 100'000;
};

/// A robot among others: where it is and wants to go.
struct Traveller {
  ManifoldPose pose;
  Footprint footprint;
  std::vector<ManifoldPose> path;  ///< from where it is to its goal; empty: it has none, and stands
};

enum class Leave : std::uint8_t {
  go,        ///< the way is its own
  wait,      ///< so far, and there it waits: another one comes through ahead
  give_way,  ///< it stands in another's way, and goes where it does not
};

/// What a robot may drive now.
struct Clearance {
  Leave leave = Leave::go;
  std::vector<ManifoldPose> path;  ///< empty: it stays where it is
};

/// Keeps the robots of a team clear of one another in place and time. Robots have the right of way in an
/// order. Each in turn holds the way that it drives next; one that would come to where another with more
/// right is at that time goes round, or waits where it bars nobody's way, or, where it stands in the way
/// itself, gives way to the nearest place where it does not. As rights are an order, no robots wait for one
/// another in a circle; one that cannot give way takes the right of the one that it bars, which then has to.
/// Robots that stand and have no goal have the least right.
///
/// Two layers of an island that lie over each other in projection are one to it: robots on them keep clear
/// too.
class Coordinator {
 public:
  explicit Coordinator(const CoordinationOptions& options = {}) : options_(options) {}

  /// By name: a clearance for each whose pose is on the planner's map. A function of this and what came
  /// before.
  std::map<std::string, Clearance> coordinate(Planner& planner, const std::map<std::string, Traveller>& team);

 private:
  CoordinationOptions options_;
  std::vector<std::string> rights_;  // the first has most
};

}  // namespace isthmus
