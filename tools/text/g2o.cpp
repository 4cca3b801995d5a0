#include "tools/text/g2o.hpp"

#include <Eigen/LU>
#include <cmath>

#include "tools/text/words.hpp"

namespace isthmus {
namespace {

class G2oReader {
 public:
  explicit G2oReader(const std::string& file) : words_(file) {}

  G2oFile read() {
    while (words_.next()) {
      if (words_.word(0) == "FIX") continue;
      if (words_.word(0) == "VERTEX_SE2") {
        take_vertex();
      } else if (words_.word(0) == "EDGE_SE2") {
        take_edge();
      } else {
        words_.fail("unknown line '" + std::string(words_.word(0)) + "'");
      }
    }
    return std::move(result_);
  }

 private:
  void take_vertex() {
    words_.expect_words(5);
    std::optional<Pose>& vertex = result_.vertices[words_.integer(1)];
    if (vertex) words_.fail("vertex " + std::string(words_.word(1)) + " is given twice");
    vertex = pose_at(2);
  }

  void take_edge() {
    words_.expect_words(12);
    G2oFileEdge edge{words_.integer(1), words_.integer(2), pose_at(3), information_at(6), words_.line()};
    if (edge.from == edge.to) words_.fail("an edge from a vertex to itself");
    result_.vertices.try_emplace(edge.from);
    result_.vertices.try_emplace(edge.to);
    result_.edges.push_back(edge);
  }

  Pose pose_at(std::size_t word) const {
    return {words_.number(word), words_.number(word + 1), wrap_angle(words_.number(word + 2))};
  }

  Eigen::Matrix3d information_at(std::size_t word) const {
    Eigen::Matrix3d information;
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column)
        information(row, column) = information(column, row) = words_.number(word++);
    }
    if (information(2, 2) <= 0 || information(0, 0) <= 0 ||
        information.topLeftCorner<2, 2>().determinant() <= 0)
      words_.fail("information is not positive definite");
    return information;
  }

  WordReader words_;
  G2oFile result_;
};

}  // namespace

G2oFile read_g2o(const std::string& file) { return G2oReader(file).read(); }

}  // namespace isthmus
