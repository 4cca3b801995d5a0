#include <Eigen/Geometry>

#include "server/output/format/number.hpp"
#include "server/output/vector_plan/plan_files.hpp"

namespace isthmus {
namespace {

constexpr double picture_margin_m = 1;

Eigen::AlignedBox2d box_of(const VectorPlan& plan) {
  Eigen::AlignedBox2d box(Eigen::Vector2d::Zero());
  for (const PlanWall& wall : plan.walls) box.extend(wall.a).extend(wall.b);
  for (const PlanPole& pole : plan.poles) box.extend(pole.centre);
  return {box.min() - Eigen::Vector2d::Constant(picture_margin_m),
          box.max() + Eigen::Vector2d::Constant(picture_margin_m)};
}

// SVG's y points down.
std::string xy(const Eigen::Vector2d& point) { return fixed(point.x(), 3) + ' ' + fixed(-point.y(), 3); }

template <class Lines>
std::string path(const Lines& lines, const std::string& style) {
  std::string text = "<path fill=\"none\" " + style + " d=\"";
  for (const auto& line : lines) text += "M " + xy(line.a) + " L " + xy(line.b) + '\n';
  return text + "\"/>\n";
}

std::string circle(const PlanPole& pole) {
  return "<circle cx=\"" + fixed(pole.centre.x(), 3) + "\" cy=\"" + fixed(-pole.centre.y(), 3) + "\" r=\"" +
         fixed(pole.radius_known ? pole.radius_m : 0.05, 3) + "\"/>\n";
}

/// Below the plan, with its length.
std::string scale_bar(const Eigen::AlignedBox2d& box) {
  const double width = box.sizes().x();
  double length = 1;
  for (const double candidate : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0})
    if (candidate <= 0.25 * width) length = candidate;
  const double text_m = 0.02 * width + 0.2, tick = 0.4 * text_m;
  const Eigen::Vector2d left = box.min() + Eigen::Vector2d(0, -tick),
                        right = left + Eigen::Vector2d(length, 0);
  const Eigen::Vector2d up(0, tick);
  return "<path fill=\"none\" stroke=\"#5a606c\" stroke-width=\"" + fixed(0.15 * text_m, 3) + "\" d=\"M " +
         xy(left + up) + " L " + xy(left) + " L " + xy(right) + " L " + xy(right + up) + "\"/>\n<text x=\"" +
         fixed(right.x() + 0.5 * text_m, 3) + "\" y=\"" + fixed(-left.y(), 3) + "\" font-size=\"" +
         fixed(text_m, 3) + "\" font-family=\"sans-serif\" fill=\"#5a606c\">" + fixed(length, 0) +
         " m</text>\n";
}

}  // namespace

std::string plan_svg(const VectorPlan& plan) {
  Eigen::AlignedBox2d box = box_of(plan);
  const std::string bar = scale_bar(box);
  box.extend(box.min() - Eigen::Vector2d::Constant(0.02 * box.sizes().x() + 0.5));
  const Eigen::Vector2d size = box.sizes();
  const double pixels = 1600 / std::max(size.x(), size.y());
  const double stroke = std::max(0.04, 1.2 / pixels);
  std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + fixed(size.x() * pixels, 0) +
                     "\" height=\"" + fixed(size.y() * pixels, 0) + "\" viewBox=\"" +
                     fixed(box.min().x(), 3) + ' ' + fixed(-box.max().y(), 3) + ' ' + fixed(size.x(), 3) +
                     ' ' + fixed(size.y(), 3) + "\">\n<rect x=\"" + fixed(box.min().x(), 3) + "\" y=\"" +
                     fixed(-box.max().y(), 3) + "\" width=\"" + fixed(size.x(), 3) + "\" height=\"" +
                     fixed(size.y(), 3) + "\" fill=\"#fcfcfc\"/>\n";
  const std::string width = "stroke-width=\"" + fixed(stroke, 3) + "\"";
  text += path(plan.openings, "stroke=\"#0072b2\" stroke-dasharray=\"0.15 0.1\" " + width);
  text += path(plan.walls, "stroke=\"#262a33\" stroke-linecap=\"round\" " + width);
  text += "<g fill=\"#d55e00\">\n";
  for (const PlanPole& pole : plan.poles) text += circle(pole);
  return text + "</g>\n" + bar + "</svg>\n";
}

}  // namespace isthmus
