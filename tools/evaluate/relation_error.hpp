#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/trajectories.hpp"

namespace isthmus {

/// A true relation: the pose of robot 2 at time 2 in the frame of robot 1 at time 1.
struct TrueRelation {
  std::string robot1;  ///< upper case
  std::int64_t utime1 = 0;
  std::string robot2;
  std::int64_t utime2 = 0;
  Pose from_1_to_2;
  std::string kind;  ///< intra, inter
};

/// Reads `t1 t2 x y z roll pitch yaw` lines (seconds, metres, radians; `#` comments) as relations of `robot`,
/// kind intra. Throws FileError naming file and line.
std::vector<TrueRelation> read_benchmark_relations(const std::string& file, const std::string& robot);

/// Reads `robot1,utime1_us,robot2,utime2_us,x_m,y_m,yaw_rad,kind`. Throws FileError naming file and line.
std::vector<TrueRelation> read_team_relations(const std::string& file);

/// Of a set of values; all zero where there are none. The deviation is the sample's (n − 1).
struct Statistics {
  double mean = 0;
  double deviation = 0;
  double median = 0;
  double max = 0;
  double rms = 0;
};
Statistics statistics(std::vector<double> values);

/// What the relations of one kind say of a team's trajectories.
struct RelationErrors {
  std::size_t count = 0;    ///< relations compared
  std::size_t missing = 0;  ///< no pose within 0.1 s, or the two poses are not on one island
  Statistics translation_m;
  Statistics rotation_deg;
  Statistics squared_translation_m2;
  Statistics squared_rotation_deg2;
};

/// By how much the map's relative pose is off, component by component; nothing where it has none: no pose
/// within 0.1 s, or the two are not on one island.
std::optional<Pose> relation_error(const TrueRelation& truth, const TeamTrajectories& team);

/// The metric of Kümmerle et al. (Autonomous Robots 27, 2009): the component-wise difference of the relative
/// pose in the trajectories and the true one, as absolute translational and rotational error. By kind.
std::map<std::string, RelationErrors> evaluate_relations(const std::vector<TrueRelation>& relations,
                                                         const TeamTrajectories& team);

}  // namespace isthmus
