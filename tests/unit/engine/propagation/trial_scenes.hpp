#pragma once

#include <cmath>

#include "server/engine/propagation/trial.hpp"
#include "tests/support/ways.hpp"

namespace isthmus::testing {

inline Relation sighting_tie(PatchId a, PatchId b, const Pose& a_from_b, double sigma_m = 0.02,
                             double sigma_rad = 0.01) {
  const double by_m = 1 / (sigma_m * sigma_m);
  Relation relation;
  relation.a = a;
  relation.b = b;
  relation.kind = RelationKind::relative_pose;
  relation.measurement =
      RelativePose{a_from_b, Eigen::Vector3d(by_m, by_m, 1 / (sigma_rad * sigma_rad)).asDiagonal()};
  relation.origin = {OriginKind::sighting, ClosureId{0}};
  return relation;
}

/// Two ways whose poses in the world are known, and what a closure says of them.
struct Case {
  Map map;
  std::vector<Pose> world;  // by patch
  std::vector<PatchId> first;
  std::vector<PatchId> second;
  Proposal proposal;

  Case() { proposal.prior_log_odds = TrialOptions{}.agreed_log_odds; }
  template <class Seen>
  void add(const Seen& walls, const std::vector<Pose>& poses, bool to_first, const Pose& map_from_world) {
    (to_first ? first : second) = add_way(map, walls, poses, map_from_world);
    world.insert(world.end(), poses.begin(), poses.end());
  }
  const Pose& truth(PatchId id) const { return world[static_cast<std::size_t>(id.value)]; }
  Pose true_relative(PatchId a, PatchId b) const { return ominus(truth(b), truth(a)); }
  /// That b lies in a where it truly does, but for `off`.
  void say(PatchId a, PatchId b, const Pose& off = {}, double sigma_m = 0.02, double sigma_rad = 0.01) {
    proposal.relations.push_back(sighting_tie(a, b, true_relative(a, b) * off, sigma_m, sigma_rad));
  }
  Trial tried(const EngineOptions& options = {}) const {
    Trial trial(map, proposal, options, 0);
    trial.finish(0);
    return trial;
  }
};

/// A merge of the islands of two ways, proposed by six sightings of either direction.
template <class Seen>
Case merge_of(const Seen& of_first, const std::vector<Pose>& first, const Seen& of_second,
              const std::vector<Pose>& second) {
  Case made;
  made.add(of_first, first, true, {});
  made.add(of_second, second, false, second_from_world);
  made.proposal.id = ClosureId{0};
  made.proposal.merge = true;
  made.proposal.older = PatchId{0};
  made.proposal.younger = made.second.front();
  made.proposal.older_from_younger = inverse(second_from_world);
  made.proposal.supporters = 6;
  made.proposal.two_way = true;
  return made;
}

/// A loop of one island that has lost its way between the two: a link that says next to nothing ties them.
template <class Seen>
Case loop_of(const Seen& of_first, const std::vector<Pose>& first, const Seen& of_second,
             const std::vector<Pose>& second, double link_sigma_m = 1) {
  Case made = merge_of(of_first, first, of_second, second);
  made.map.move_island(made.second.front(), inverse(second_from_world));
  const PatchId a = made.first.back(), b = made.second.front();
  made.map.relate(sighting_tie(a, b, made.true_relative(a, b), link_sigma_m, 0.5));
  made.proposal.merge = false;
  return made;
}

inline const std::vector<Pose> outward = {{-1, -1.5, 0}, {0.5, -1.4, 0.1}, {1.8, -1, 1.2}};
inline const std::vector<Pose> homeward = {{2, 0.2, 3}, {0.8, 0.1, 3.1}, {-0.5, 0, -3.1}};

//   +---------------+
//   |      |        |    A screen where the first way looked through. All else is alike, and matches.
//   |   o  |        |
//   +---------------+
inline Walls with_a_screen(Walls walls) {
  walls.push_back({{1, -1.5}, {1, 1.5}});
  return walls;
}

/// A room whose walls are of teeth, so steep that no beam finds its line on a plain wall.
inline Walls toothed_room() {
  Walls walls;
  const auto add = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const Eigen::Vector2d along = (to - from).normalized(), out(along.y(), -along.x());
    Eigen::Vector2d before = from;
    for (int i = 1; i * 0.2 < (to - from).norm(); ++i) {
      const Eigen::Vector2d next = from + i * 0.2 * along + (i % 2 == 0 ? -0.3 : 0.3) * out;
      walls.push_back({before, next});
      before = next;
    }
    walls.push_back({before, to});
  };
  add({-4, -3}, {4, -3});
  add({4, -3}, {4, 3});
  add({4, 3}, {-4, 3});
  add({-4, 3}, {-4, -3});
  return walls;
}

}  // namespace isthmus::testing
