#include "tools/simulate/truth/truth_files.hpp"

#include "server/output/format/atomic_file.hpp"
#include "server/output/format/csv.hpp"
#include "server/output/format/number.hpp"
#include "server/output/format/tum.hpp"
#include "server/output/pictures/map_sheet.hpp"
#include "server/output/pictures/marks.hpp"
#include "server/output/pictures/way_pen.hpp"
#include "tools/simulate/truth/plan_picture.hpp"

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

std::string relations_csv(const std::vector<ScanRelation>& relations) {
  std::string text = "robot1,utime1_us,robot2,utime2_us,x_m,y_m,yaw_rad,kind\n";
  for (const ScanRelation& r : relations) {
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

/// Every surface, in metres of the world that the true poses are in.
void write_walls(const FloorPlan& plan, const std::string& path) {
  CsvFile csv(path, "ax_m,ay_m,bx_m,by_m");
  for (const Segment& segment : plan.segments)
    csv.row(segment.a.x(), segment.a.y(), segment.b.x(), segment.b.y());
  csv.commit();
}

void draw_way(MapSheet& sheet, const RobotTruth& truth, const WayStyle& style) {
  WayPen pen(sheet.canvas(), sheet.window(), style);
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    if (i > 0 && truth.poses[i].stretch != truth.poses[i - 1].stretch) pen.lift();
    pen.to(position(truth.poses[i].world_from_robot));
  }
}

void write_floor_plan(const FloorPlan& plan, const std::vector<RobotTruth>& truth, const std::string& path) {
  Legend legend;
  for (const RobotTruth& robot : truth) legend.push_back(way_entry(robot.robot, way_style(legend.size())));
  legend.push_back(start_entry());
  legend.push_back(end_entry());
  MapSheet sheet(plain_grid(plan, OccupancyGrid::free), {"The simulated building", "the robots' true ways"},
                 legend);
  draw_walls(sheet, plan);
  for (std::size_t i = 0; i < truth.size(); ++i) draw_way(sheet, truth[i], way_style(i));
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i].poses.empty()) continue;
    draw_start(sheet.canvas(), sheet.window(), truth[i].poses.front().world_from_robot, way_style(i));
    draw_end(sheet.canvas(), sheet.window(), truth[i].poses.back().world_from_robot, way_style(i));
  }
  sheet.write(path);
}

}  // namespace

void write_truth(const Scenario& scenario, const SimulatedRun& run,
                 const std::vector<ScanRelation>& relations, const std::string& directory) {
  make_directory(directory);
  for (const RobotTruth& robot : run.truth) write_file(directory + '/' + robot.robot + ".tum", tum(robot));
  write_file(directory + "/relations.csv", relations_csv(relations));
  write_file(directory + "/outliers.csv", outliers_csv(run.false_sightings));
  write_walls(scenario.plan, directory + "/floor_plan.csv");
  write_floor_plan(scenario.plan, run.truth, directory + "/floor_plan.png");
}

}  // namespace isthmus
