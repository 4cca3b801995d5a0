#include "tools/text/g2o.hpp"

#include <Eigen/LU>
#include <cmath>
#include <string_view>

#include "tools/text/lines.hpp"
#include "tools/text/numbers.hpp"

namespace isthmus {
namespace {

class G2oReader {
 public:
  explicit G2oReader(const std::string& file) : lines_(file) {}

  G2oFile read() {
    while (const auto line = lines_.next()) {
      split_words(*line, words_);
      if (words_.empty() || words_[0].front() == '#' || words_[0] == "FIX") continue;
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
    std::optional<Pose>& vertex = result_.vertices[id_at(1)];
    if (vertex) fail("vertex " + std::string(words_[1]) + " is given twice");
    vertex = pose_at(2);
  }

  void take_edge() {
    expect_words(12);
    G2oFileEdge edge{id_at(1), id_at(2), pose_at(3), information_at(6), lines_.number()};
    if (edge.from == edge.to) fail("an edge from a vertex to itself");
    result_.vertices.try_emplace(edge.from);
    result_.vertices.try_emplace(edge.to);
    result_.edges.push_back(edge);
  }

  std::int64_t id_at(std::size_t word) const {
    const auto id = parse_integer(words_[word]);
    if (!id) fail("'" + std::string(words_[word]) + "' is no vertex id");
    return *id;
  }

  Pose pose_at(std::size_t word) const {
    return {number_at(word), number_at(word + 1), wrap_angle(number_at(word + 2))};
  }

  Eigen::Matrix3d information_at(std::size_t word) const {
    Eigen::Matrix3d information;
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column)
        information(row, column) = information(column, row) = number_at(word++);
    }
    if (information(2, 2) <= 0 || information(0, 0) <= 0 ||
        information.topLeftCorner<2, 2>().determinant() <= 0)
      fail("information is not positive definite");
    return information;
  }

  double number_at(std::size_t word) const {
    const auto value = parse_double(words_[word]);
    if (!value || !std::isfinite(*value)) fail("'" + std::string(words_[word]) + "' is not a finite number");
    return *value;
  }

  void expect_words(std::size_t count) const {
    if (words_.size() != count)
      fail("expected " + std::to_string(count) + " fields, found " + std::to_string(words_.size()));
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw FileError(lines_.file(), lines_.number(), reason);
  }

  LineReader lines_;
  std::vector<std::string_view> words_;
  G2oFile result_;
};

}  // namespace

G2oFile read_g2o(const std::string& file) { return G2oReader(file).read(); }

}  // namespace isthmus
