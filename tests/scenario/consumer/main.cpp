// One scan becomes a map of one patch.
#include <cstdio>
#include <isthmus/robot_t.hpp>

#include "server/engine/engine.hpp"

int main() {
  isthmus::robot_t message{};
  message.name = "R1";
  isthmus::RobotEvent robot;
  robot.robot = message.name;
  robot.laser.range_max_m = 20;
  isthmus::Engine engine;
  engine.handle({1, robot});
  engine.handle({2, isthmus::OdometryEvent{"R1", 1'000'000, {}}});
  engine.handle({3, isthmus::ScanEvent{"R1", {1'000'000, -1.5, 0.02, std::vector<float>(150, 3.0F)}}});
  engine.finish();
  std::printf("%zu patch\n", engine.copy().patches.size());
}
