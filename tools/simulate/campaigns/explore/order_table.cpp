#include "tools/simulate/campaigns/explore/order_table.hpp"

#include "server/output/format/atomic_file.hpp"
#include "server/output/format/number.hpp"

namespace isthmus {
namespace {

double length_m(const OrderView& view) {
  Eigen::Vector2d here = position(view.planner.project(view.pose));
  double length = 0;
  for (const ManifoldPose& pose : view.order.path) {
    const Eigen::Vector2d next = position(view.planner.project(pose));
    length += (next - here).norm();
    here = next;
  }
  return length;
}

}  // namespace

OrderTable::OrderTable() {
  rows_ << "time_s,robot,island,x_m,y_m,yaw_rad,true_x_m,true_y_m,true_yaw_rad,order,goal,goal_x_m,goal_y_m,"
           "way_m,stuck_s\n";
}

void OrderTable::add(const OrderView& view) {
  const auto put = [&](double value) { rows_ << fixed(value, 3) << ','; };
  rows_ << fixed(view.time_s, 1) << ',' << view.robot << ','
        << view.planner.map().graph.island(view.pose.patch).value << ',';
  for (const Pose& pose : {view.planner.project(view.pose), view.world_from_robot})
    for (const double value : {pose.x, pose.y, pose.yaw}) put(value);
  rows_ << word(view.order.reason) << ',' << view.order.number << ',';
  if (view.order.goal) {
    const Pose goal = view.planner.project(view.order.goal->viewpoint);
    put(goal.x);
    put(goal.y);
  } else {
    rows_ << ",,";
  }
  put(length_m(view));
  rows_ << fixed(view.stuck_s, 1) << '\n';
}

void OrderTable::write(const std::string& path) const {
  AtomicFile file(path);
  file.write(rows_.str());
  file.commit();
}

}  // namespace isthmus
