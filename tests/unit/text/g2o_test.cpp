#include "tools/text/g2o.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

G2oFile read(const std::string& text) {
  const TemporaryDirectory directory;
  return read_g2o(directory.write("graph.g2o", text));
}

std::string error_in(const std::string& text) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("graph.g2o", text);
  const std::string error = error_of([&] { read_g2o(file); });
  return error.starts_with(file) ? error.substr(file.size()) : error;
}

TEST(G2o, VerticesAndEdgesAreRead) {
  const G2oFile file = read(
      "# by hand\nVERTEX_SE2 7 1 2 0.5\nFIX 7\n\n"
      "EDGE_SE2 7 -9 1.1 1.8 7.0 20 3 1 10 2 50\n");
  ASSERT_EQ(file.vertices.size(), 2U);
  EXPECT_EQ(file.vertices.at(7), (Pose{1, 2, 0.5}));
  EXPECT_FALSE(file.vertices.at(-9)) << "an edge names it, no line tells its pose";
  ASSERT_EQ(file.edges.size(), 1U);
  const G2oFileEdge& edge = file.edges[0];
  EXPECT_EQ(edge.from, 7);
  EXPECT_EQ(edge.to, -9);
  EXPECT_EQ(edge.line, 5);
  EXPECT_EQ(edge.from_to, (Pose{1.1, 1.8, wrap_angle(7)}));
  Eigen::Matrix3d information;
  information << 20, 3, 1, 3, 10, 2, 1, 2, 50;
  EXPECT_EQ(edge.information, information);
}

TEST(G2o, ErrorsNameFileLineAndReason) {
  const std::string good = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n";
  EXPECT_EQ(error_in(good), "");
  EXPECT_EQ(error_in(good + "EDGE_SE3 0 1\n"), ":2: unknown line 'EDGE_SE3'");
  EXPECT_EQ(error_in(good + "\nEDGE_SE2 0 1 1 0\n"), ":3: expected 12 fields, found 5");
  EXPECT_EQ(error_in("EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1 7\n"), ":1: expected 12 fields, found 13");
  EXPECT_EQ(error_in("EDGE_SE2 0 1 1 0 zero 1 0 0 1 0 1\n"), ":1: 'zero' is not a finite number");
  EXPECT_EQ(error_in("EDGE_SE2 0 1 1 0 nan 1 0 0 1 0 1\n"), ":1: 'nan' is not a finite number");
  EXPECT_EQ(error_in("EDGE_SE2 0 1.5 1 0 0 1 0 0 1 0 1\n"), ":1: '1.5' is not an integer");
  EXPECT_EQ(error_in("EDGE_SE2 3 3 1 0 0 1 0 0 1 0 1\n"), ":1: an edge from a vertex to itself");
  EXPECT_EQ(error_in("EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\n"), ":1: information is not positive definite");
  EXPECT_EQ(error_in("EDGE_SE2 0 1 1 0 0 1 0 0 1 0 0\n"), ":1: information is not positive definite");
  EXPECT_EQ(error_in("VERTEX_SE2 0 0 0\n"), ":1: expected 5 fields, found 4");
  EXPECT_EQ(error_in("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 0 0 0 0\n"), ":2: vertex 0 is given twice");
}

}  // namespace
}  // namespace isthmus
