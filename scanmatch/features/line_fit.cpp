#include "scanmatch/features/line_fit.hpp"

#include <cmath>

namespace isthmus {
namespace {

constexpr int iterations = 3;  // weights depend on the line's direction, which hardly moves after the first

double variance_across(const BeamPoint& point, const Eigen::Vector2d& across) {
  return across.dot(point.covariance * across);
}

/// The weighted centre and the direction of least moment across it.
void fit_once(std::span<const BeamPoint> points, Line& line) {
  const Eigen::Vector2d across = line.across();
  double weight = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const BeamPoint& point : points) {
    const double w = 1 / variance_across(point, across);
    weight += w;
    sum += w * point.position;
  }
  line.centre = sum / weight;
  Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
  for (const BeamPoint& point : points) {
    const Eigen::Vector2d offset = point.position - line.centre;
    moments += offset * offset.transpose() / variance_across(point, across);
  }
  const double yaw = 0.5 * std::atan2(2 * moments(0, 1), moments(0, 0) - moments(1, 1));
  const Eigen::Vector2d direction(std::cos(yaw), std::sin(yaw));
  line.along = direction.dot(line.along) < 0 ? Eigen::Vector2d(-direction) : direction;
}

void judge(std::span<const BeamPoint> points, Line& line) {
  const Eigen::Vector2d across = line.across();
  double rho_information = 0, alpha_information = 0;
  line.chi_squared = line.worst_sigmas = 0;
  for (const BeamPoint& point : points) {
    const double w = 1 / variance_across(point, across);
    const double squared = w * std::pow(line.across_m(point.position), 2);
    rho_information += w;
    alpha_information += w * std::pow(line.along_m(point.position), 2);
    line.chi_squared += squared;
    line.worst_sigmas = std::max(line.worst_sigmas, std::sqrt(squared));
  }
  line.rho_variance = 1 / rho_information;
  line.alpha_variance = 1 / alpha_information;
}

}  // namespace

std::optional<Line> fit_line(std::span<const BeamPoint> points) {
  if (points.size() < 2) return std::nullopt;
  const Eigen::Vector2d chord = points.back().position - points.front().position;
  if (!(chord.norm() > 1e-6)) return std::nullopt;
  Line line;
  line.along = chord.normalized();
  for (int iteration = 0; iteration < iterations; ++iteration) fit_once(points, line);
  judge(points, line);
  return line;
}

double across_variance(const Line& line, double along_m) {
  return line.rho_variance + along_m * along_m * line.alpha_variance;
}

std::optional<Eigen::Vector2d> meeting_point(const Line& one, const Line& other) {
  const double sine = other.across().dot(one.along);
  if (std::abs(sine) < 1e-6) return std::nullopt;
  return one.at(other.across().dot(other.centre - one.centre) / sine);
}

}  // namespace isthmus
