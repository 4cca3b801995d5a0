#include "tools/inspect/pose_graph.hpp"

#include <cmath>

#include "server/output/graph_g2o.hpp"
#include "tools/text/lines.hpp"
#include "tools/text/numbers.hpp"

namespace isthmus {
namespace {

class PoseGraphReader {
 public:
  explicit PoseGraphReader(const std::string& file) : lines_(file) {}

  PoseGraph read() {
    while (const auto line = lines_.next()) {
      split_words(*line, words_);
      if (words_.empty() || words_[0] == "FIX") continue;
      if (words_[0] == "VERTEX_SE2") {
        take_vertex();
      } else if (words_[0] == "EDGE_SE2") {
        take_edge();
      } else {
        fail("unknown line '" + std::string(words_[0]) + "'");
      }
    }
    return std::move(result_);
  }

 private:
  void take_vertex() {
    expect_words(5);
    const PatchId id{static_cast<std::int32_t>(result_.poses.size())};
    if (parse_integer(words_[1]) != id.value) fail("vertex ids must be 0, 1, 2, ... in order");
    result_.graph.add_patch(id);
    result_.poses.push_back(pose_at(2));
  }

  void take_edge() {
    expect_words(12);
    G2oEdge edge{pose_at(3), Eigen::Matrix3d::Zero()};
    std::size_t word = 6;
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column) {
        edge.information(row, column) = edge.information(column, row) = number_at(word++);
      }
    }
    Relation relation;
    relation.a = patch_at(1);
    relation.b = patch_at(2);
    if (relation.a == relation.b) fail("an edge from a vertex to itself");
    relation.kind = RelationKind::relative_pose;
    relation.measurement = relative_pose(edge);
    result_.graph.add(relation);
  }

  PatchId patch_at(std::size_t word) const {
    const auto id = parse_integer(words_[word]);
    if (!id || *id < 0 || *id >= static_cast<std::int64_t>(result_.poses.size())) {
      fail("no vertex '" + std::string(words_[word]) + "'");
    }
    return PatchId{static_cast<std::int32_t>(*id)};
  }

  Pose pose_at(std::size_t word) const {
    return {number_at(word), number_at(word + 1), wrap_angle(number_at(word + 2))};
  }

  double number_at(std::size_t word) const {
    const auto value = parse_double(words_[word]);
    if (!value || !std::isfinite(*value)) fail("'" + std::string(words_[word]) + "' is not a finite number");
    return *value;
  }

  void expect_words(std::size_t count) const {
    if (words_.size() != count) {
      fail("expected " + std::to_string(count) + " fields, found " + std::to_string(words_.size()));
    }
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(lines_.file(), lines_.number(), reason);
  }

  LineReader lines_;
  std::vector<std::string_view> words_;
  PoseGraph result_;
};

}  // namespace

PoseGraph read_pose_graph(const std::string& file) { return PoseGraphReader(file).read(); }

}  // namespace isthmus
