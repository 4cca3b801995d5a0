// A robot for Isthmus in C++: it drives in a circle in a room of 8 x 6 m, and is told where it is.
//   g++ -std=c++17 robot.cpp $(pkg-config --cflags --libs isthmus) -o robot
//   ./robot NAME BARCODE [SECONDS] [LCM_URL]
#include <bot_core/planar_lidar_t.hpp>
#include <bot_core/pose_t.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <isthmus/manifold_pose_t.hpp>
#include <isthmus/robot_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <string>

// From (x, y) to the nearest wall in a direction; walls at x = -4 and 4, y = -3 and 3.
static float range_m(double x, double y, double direction_rad) {
  const double c = std::cos(direction_rad), s = std::sin(direction_rad);
  const double along_x = c > 0 ? (4 - x) / c : c < 0 ? (-4 - x) / c : 1e9;
  const double along_y = s > 0 ? (3 - y) / s : s < 0 ? (-3 - y) / s : 1e9;
  return static_cast<float>(std::fmin(along_x, along_y));
}

static void told(const lcm::ReceiveBuffer*, const std::string&, const isthmus::manifold_pose_t* pose, void*) {
  const double* at = pose->map_from_robot;
  std::printf("%s: island %d, %.2f m, %.2f m, %.2f rad\n", pose->robot.c_str(), pose->island, at[0], at[1],
              at[2]);
}

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "usage: robot NAME BARCODE [SECONDS] [LCM_URL]\n"), 2;
  const std::string name = argv[1];
  const int rounds = static_cast<int>(10 * (argc > 3 ? std::atof(argv[3]) : 60));
  lcm::LCM lcm(argc > 4 ? argv[4] : "udpm://239.255.76.67:7667?ttl=0");
  if (!lcm.good()) return 1;
  lcm.subscribeFunction(name + "_POSE", told, static_cast<void*>(nullptr));
  for (int i = 0; i < rounds; ++i) {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const std::int64_t utime = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
    if (i % 20 == 0) {  // who it is: at the start, and again for a server that comes later
      isthmus::robot_t robot{};
      robot.utime = utime, robot.name = name, robot.barcode = std::atoi(argv[2]);
      robot.range_min_m = 0.1, robot.range_max_m = 20, robot.footprint_radius_m = 0.2;
      lcm.publish(name + "_ROBOT", &robot);
    }
    const double turned = 0.05 * i, x = std::cos(turned), y = std::sin(turned), yaw = turned + M_PI / 2;
    bot_core::pose_t odometry{};  // of the scan's own moment, just before the scan
    odometry.utime = utime, odometry.pos[0] = x, odometry.pos[1] = y;
    odometry.orientation[0] = std::cos(yaw / 2), odometry.orientation[3] = std::sin(yaw / 2);
    lcm.publish(name + "_ODOMETRY", &odometry);
    bot_core::planar_lidar_t scan{};
    scan.utime = utime, scan.nranges = 181, scan.rad0 = static_cast<float>(-M_PI / 2);
    scan.radstep = static_cast<float>(M_PI / 180);
    for (int k = 0; k < 181; ++k) scan.ranges.push_back(range_m(x, y, yaw - M_PI / 2 + k * M_PI / 180));
    lcm.publish(name + "_SCAN", &scan);
    while (lcm.handleTimeout(100) > 0) {
      const auto then = std::chrono::system_clock::now().time_since_epoch();
      if (std::chrono::duration_cast<std::chrono::microseconds>(then).count() > utime + 100000) break;
    }
  }
}
