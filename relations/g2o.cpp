#include "relations/g2o.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace isthmus {
namespace {

struct Edge {
  std::int64_t from = 0;
  std::int64_t to = 0;
  Pose from_to;
  Eigen::Matrix3d information;
};

using Vertices = std::map<std::int64_t, std::optional<Pose>>;

struct Lines {
  Vertices vertices;
  std::vector<Edge> edges;
};

/// Whole-field numbers: "1.5x" and a missing field are errors.
template <class Number>
Number field(std::istringstream& line, const char* what) {
  std::string text;
  if (!(line >> text)) throw std::runtime_error(std::string("missing ") + what);
  std::istringstream number(text);
  Number value{};
  if (!(number >> value) || number.peek() != std::char_traits<char>::eof())
    throw std::runtime_error(std::string(what) + " is not a number: '" + text + "'");
  return value;
}

Pose pose_fields(std::istringstream& line) {
  const double x = field<double>(line, "x");
  const double y = field<double>(line, "y");
  return {x, y, wrap_angle(field<double>(line, "yaw"))};
}

void expect_end(std::istringstream& line) {
  std::string rest;
  if (line >> rest) throw std::runtime_error("unexpected field '" + rest + "'");
}

Edge edge_fields(std::istringstream& line) {
  Edge edge;
  edge.from = field<std::int64_t>(line, "first vertex id");
  edge.to = field<std::int64_t>(line, "second vertex id");
  if (edge.from == edge.to) throw std::runtime_error("an edge joins a vertex to itself");
  edge.from_to = pose_fields(line);
  for (int row = 0; row < 3; ++row)
    for (int column = row; column < 3; ++column)
      edge.information(row, column) = edge.information(column, row) = field<double>(line, "information");
  if (edge.information(2, 2) <= 0 || edge.information(0, 0) <= 0 ||
      edge.information.topLeftCorner<2, 2>().determinant() <= 0)
    throw std::runtime_error("information is not positive definite");
  return edge;
}

void read_line(std::istringstream& line, Lines& lines) {
  std::string tag;
  if (!(line >> tag) || tag.front() == '#' || tag == "FIX") return;
  if (tag == "VERTEX_SE2") {
    const auto id = field<std::int64_t>(line, "vertex id");
    lines.vertices[id] = pose_fields(line);
  } else if (tag == "EDGE_SE2") {
    lines.edges.push_back(edge_fields(line));
    lines.vertices.try_emplace(lines.edges.back().from);
    lines.vertices.try_emplace(lines.edges.back().to);
  } else {
    throw std::runtime_error("unknown tag '" + tag + "'");
  }
  expect_end(line);
}

/// The pose of an edge's one end from the other's; whether that was possible and new.
bool extend(Vertices& vertices, const Edge& edge) {
  std::optional<Pose>& from = vertices.at(edge.from);
  std::optional<Pose>& to = vertices.at(edge.to);
  if (from.has_value() == to.has_value()) return false;
  if (from)
    to = *from * edge.from_to;
  else
    from = *to * inverse(edge.from_to);
  return true;
}

void follow_odometry(Vertices& vertices, const std::map<std::int64_t, const Edge*>& odometry) {
  for (auto step = odometry.begin(); step != odometry.end(); ++step) extend(vertices, *step->second);
  for (auto step = odometry.rbegin(); step != odometry.rend(); ++step) extend(vertices, *step->second);
}

/// Missing poses are composed: as far as consecutive ids lead, then over one other edge, and so on; each part
/// of the graph that has no pose at all starts at the origin.
void complete_poses(Lines& lines) {
  std::map<std::int64_t, const Edge*> odometry;
  for (const Edge& edge : lines.edges)
    if (std::abs(edge.to - edge.from) == 1) odometry.emplace(std::min(edge.from, edge.to), &edge);
  while (true) {
    follow_odometry(lines.vertices, odometry);
    const auto extends = [&](const Edge& edge) { return extend(lines.vertices, edge); };
    if (std::any_of(lines.edges.begin(), lines.edges.end(), extends)) continue;
    const auto without = std::find_if(lines.vertices.begin(), lines.vertices.end(),
                                      [](const auto& vertex) { return !vertex.second; });
    if (without == lines.vertices.end()) return;
    without->second = Pose{};
  }
}

Relation relation_of(const Edge& edge, PatchId from, PatchId to) {
  const double yaw_weight = std::sqrt(2 * edge.information(2, 2));
  const double position_weight = std::sqrt(2 / edge.information.topLeftCorner<2, 2>().inverse().trace());
  const Vector5d measured = form_variables(edge.from_to);
  QuadraticFormBuilder builder;
  for (int k = 0; k < 4; ++k) {
    Vector5d row = Vector5d::Zero();
    row(k) = 1;
    row(4) = -measured(k);
    builder.row((k < 2 ? yaw_weight : position_weight) * row);
  }
  Relation relation;
  relation.a = from;
  relation.b = to;
  relation.kind = RelationKind::relative_pose;
  relation.measurement = Correspondences{builder.build(), 1, {}};
  return relation;
}

PoseGraphFile pose_graph(const Lines& lines) {
  PoseGraphFile file;
  std::map<std::int64_t, PatchId> patch;
  for (const auto& [id, pose] : lines.vertices) {
    const PatchId next{static_cast<std::int32_t>(file.poses.size())};
    patch.emplace(id, next);
    file.graph.add_patch(next);
    file.poses.push_back(*pose);
  }
  for (const Edge& edge : lines.edges)
    file.graph.add(relation_of(edge, patch.at(edge.from), patch.at(edge.to)));
  return file;
}

}  // namespace

std::variant<PoseGraphFile, std::string> read_g2o(std::istream& stream, const std::string& file_name) {
  Lines lines;
  std::string text;
  for (std::int64_t number = 1; std::getline(stream, text); ++number) {
    try {
      std::istringstream line(text);
      read_line(line, lines);
    } catch (const std::runtime_error& error) {
      return file_name + ":" + std::to_string(number) + ": " + error.what();
    }
  }
  if (stream.bad()) return file_name + ": cannot be read to its end";
  if (lines.edges.empty()) return file_name + ": no EDGE_SE2 line";
  complete_poses(lines);
  return pose_graph(lines);
}

}  // namespace isthmus
