#include "tools/simulate/truth/truth_files.hpp"

#include <cmath>

#include "server/output/format/atomic_file.hpp"
#include "server/output/format/number.hpp"
#include "server/output/format/tum.hpp"

namespace isthmus {
namespace {

void write_file(const std::string& path, const std::string& text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

std::string tum(const RobotTruth& truth) {
  std::string text;
  for (const TruePose& row : truth.poses) text += tum_line(row.utime, row.world_from_robot);
  return text;
}

std::string relations_csv(const std::vector<TrueRelation>& relations) {
  std::string text = "robot1,utime1_us,robot2,utime2_us,x_m,y_m,yaw_rad,kind\n";
  for (const TrueRelation& r : relations) {
    text += r.robot1 + ',' + std::to_string(r.utime1) + ',' + r.robot2 + ',' + std::to_string(r.utime2) +
            ',' + fixed(r.pose.x, 6) + ',' + fixed(r.pose.y, 6) + ',' + fixed(r.pose.yaw, 6) +
            (r.robot1 == r.robot2 ? ",intra\n" : ",inter\n");
  }
  return text;
}

std::string outliers_csv(const std::vector<FalseSighting>& sightings) {
  std::string text = "row,utime_us,observer,barcode,kind,true_barcode,true_range_m,true_bearing_rad\n";
  for (const FalseSighting& s : sightings) {
    text += std::to_string(s.row) + ',' + std::to_string(s.reported.utime) + ',' + s.reported.robot + ',' +
            std::to_string(s.reported.barcode) + ',' + s.kind + ',';
    text += s.truth.barcode < 0 ? ",,\n"
                                : std::to_string(s.truth.barcode) + ',' + fixed(s.truth.range_m, 6) + ',' +
                                      fixed(s.truth.bearing_rad, 6) + '\n';
  }
  return text;
}

// SVG's y points down.
std::string xy(const Eigen::Vector2d& point) { return fixed(point.x(), 3) + ' ' + fixed(-point.y(), 3); }

std::string way_of(const RobotTruth& truth) {
  std::string path;
  std::size_t stretch = 0;
  for (const TruePose& pose : truth.poses) {
    path += path.empty() || pose.stretch != stretch ? " M " : " L ";
    path += xy({pose.world_from_robot.x, pose.world_from_robot.y});
    stretch = pose.stretch;
  }
  return path;
}

std::string floor_plan_svg(const FloorPlan& plan, const std::vector<RobotTruth>& truth) {
  constexpr double margin = 0.5;
  static const char* const colours[] = {"#d62728", "#1f77b4", "#2ca02c", "#ff7f0e", "#9467bd", "#8c564b"};
  const Eigen::Vector2d size = plan.high - plan.low + Eigen::Vector2d::Constant(2 * margin);
  std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + fixed(size.x() * 30, 0) +
                     "\" height=\"" + fixed(size.y() * 30, 0) + "\" viewBox=\"" +
                     fixed(plan.low.x() - margin, 3) + ' ' + fixed(-plan.high.y() - margin, 3) + ' ' +
                     fixed(size.x(), 3) + ' ' + fixed(size.y(), 3) +
                     "\">\n<rect x=\"-10000\" y=\"-10000\" width=\"20000\" height=\"20000\" "
                     "fill=\"white\"/>\n<path fill=\"none\" stroke=\"black\" stroke-width=\"0.04\" d=\"";
  for (const Segment& segment : plan.segments) text += "M " + xy(segment.a) + " L " + xy(segment.b) + '\n';
  text += "\"/>\n";
  for (std::size_t i = 0; i < truth.size(); ++i) {
    text += "<path id=\"" + truth[i].robot + "\" fill=\"none\" stroke=\"" + colours[i % std::size(colours)] +
            "\" stroke-width=\"0.03\" d=\"" + way_of(truth[i]) + "\"/>\n";
  }
  return text + "</svg>\n";
}

}  // namespace

void write_truth(const Scenario& scenario, const SimulatedRun& run,
                 const std::vector<TrueRelation>& relations, const std::string& directory) {
  make_directory(directory);
  for (const RobotTruth& robot : run.truth) write_file(directory + '/' + robot.robot + ".tum", tum(robot));
  write_file(directory + "/relations.csv", relations_csv(relations));
  write_file(directory + "/outliers.csv", outliers_csv(run.false_sightings));
  write_file(directory + "/floor_plan.svg", floor_plan_svg(scenario.plan, run.truth));
}

}  // namespace isthmus
