#pragma once

#include "server/engine/localise/localise.hpp"

namespace isthmus {

/// Whether a scan should become a patch (Howard et al. 2006, IV-A): it lies far from every patch of the
/// surroundings, or covers much that none of them covers.
bool worth_a_patch(const Map& map, const Surroundings& surroundings, const Placement& placement,
                   const Star& star, const EngineOptions& options);

/// Share of a star's free area that none of the patches covers; samples along every few beams.
double uncovered_share(const Star& star, std::span<const LocalPatch> patches_near,
                       const Pose& local_from_robot, const ExtendOptions& options);

/// Makes the observation of a placed scan a patch with its relations: those of its match, odometry's to the
/// robot's previous patch, and those of local loops that close here. Refits around it, and puts the robot at
/// its origin (eq. 15). `place` must have been settled at the scan. Returns whether a local loop was closed.
bool extend(Map& map, Robot& robot, Observation observation, const Placement& placement,
            const EngineOptions& options);

/// Odometry's account of the way from a robot's newest own patch to another, with what is to be believed of
/// it.
Relation odometry_relation(Robot& robot, PatchId next, const EngineOptions& options);

/// Puts a robot at the origin of a patch of its own (eq. 15).
void put_robot_on(Robot& robot, PatchId patch);

/// The first patch of a new island, at the origin of its own frame.
void begin_island(Map& map, Robot& robot, Observation observation, const Pose& odom_from_robot,
                  const EngineOptions& options);

}  // namespace isthmus
