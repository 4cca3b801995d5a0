#include "server/output/format/number.hpp"
#include "server/output/vector_plan/plan_files.hpp"

namespace isthmus {
namespace {

/// One group: its code, then its value, each on a line of its own.
std::string group(int code, const std::string& value) { return std::to_string(code) + '\n' + value + '\n'; }

std::string point(int first_code, const Eigen::Vector2d& at) {
  return group(first_code, fixed(at.x(), 4)) + group(first_code + 10, fixed(at.y(), 4)) +
         group(first_code + 20, "0.0");
}

std::string layer(const std::string& name, int colour) {
  return group(0, "LAYER") + group(2, name) + group(70, "0") + group(62, std::to_string(colour)) +
         group(6, "CONTINUOUS");
}

std::string line(const std::string& on_layer, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return group(0, "LINE") + group(8, on_layer) + point(10, a) + point(11, b);
}

std::string line_type() {
  return group(0, "TABLE") + group(2, "LTYPE") + group(70, "1") + group(0, "LTYPE") + group(2, "CONTINUOUS") +
         group(70, "0") + group(3, "Solid line") + group(72, "65") + group(73, "0") + group(40, "0.0") +
         group(0, "ENDTAB");
}

}  // namespace

std::string plan_dxf(const VectorPlan& plan, const std::string& frame) {
  std::string text = group(999, frame) + group(0, "SECTION") + group(2, "HEADER") + group(9, "$ACADVER") +
                     group(1, "AC1009") + group(0, "ENDSEC");
  text += group(0, "SECTION") + group(2, "TABLES") + line_type() + group(0, "TABLE") + group(2, "LAYER") +
          group(70, "3") + layer("WALLS", 7) + layer("OPENINGS", 5) + layer("POLES", 1) + group(0, "ENDTAB") +
          group(0, "ENDSEC");
  text += group(0, "SECTION") + group(2, "ENTITIES");
  for (const PlanWall& wall : plan.walls) text += line("WALLS", wall.a, wall.b);
  for (const PlanOpening& opening : plan.openings) text += line("OPENINGS", opening.a, opening.b);
  for (const PlanPole& pole : plan.poles) {
    text += group(0, "CIRCLE") + group(8, "POLES") + point(10, pole.centre) +
            group(40, fixed(pole.radius_known ? pole.radius_m : 0.05, 4));
  }
  return text + group(0, "ENDSEC") + group(0, "EOF");
}

}  // namespace isthmus
