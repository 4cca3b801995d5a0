#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <string>

#include "server/output/format/csv.hpp"
#include "server/output/grid/grid.hpp"
#include "server/output/latency.hpp"
#include "server/output/tables/graph_g2o.hpp"

namespace isthmus {
namespace {

/// A number in [low, high), to 2^-20 of the way.
rc::Gen<double> any_between(double low, double high) {
  return rc::gen::map(rc::gen::inRange(0, 1 << 20),
                      [=](int step) { return low + (high - low) * step / (1 << 20); });
}

Pose arbitrary_pose(double reach_m) {
  return {*any_between(-reach_m, reach_m), *any_between(-reach_m, reach_m), *any_between(-3.1, 3.1)};
}

Eigen::Matrix3d arbitrary_information() {
  Eigen::Matrix3d root;
  for (int i = 0; i < 9; ++i) root(i / 3, i % 3) = *any_between(-30, 30);
  return root.transpose() * root + Eigen::Matrix3d::Identity();
}

TEST(Number, EveryDoubleReadsBackAsItself) {
  EXPECT_TRUE(rc::check([](std::uint64_t bits) {
    const double value = std::bit_cast<double>(bits);
    const double back = std::strtod(number(value).c_str(), nullptr);
    RC_ASSERT((std::isnan(value) ? std::isnan(back) : back == value));
  }));
}

TEST(Number, SecondsTimesAMillionAreTheMicroseconds) {
  EXPECT_TRUE(rc::check([](std::int64_t utime) {
    std::string text = seconds(utime);
    RC_ASSERT(text.size() >= 8u);
    RC_ASSERT(text[text.size() - 7] == '.');
    text.erase(text.size() - 7, 1);
    RC_ASSERT(std::strtoll(text.c_str(), nullptr, 10) == utime);
  }));
}

TEST(Csv, AQuotedFieldReadsBackAsItWas) {
  EXPECT_TRUE(rc::check([](const std::string& text) {
    std::string field = csv_field(text);
    if (!field.empty() && field.front() == '"') {
      RC_ASSERT(field.back() == '"');
      std::string inner = field.substr(1, field.size() - 2);
      std::string back;
      for (std::size_t i = 0; i < inner.size(); ++i) {
        if (inner[i] == '"') RC_ASSERT(inner[++i] == '"');
        back += inner[i];
      }
      field = back;
    } else {
      RC_ASSERT(field.find_first_of(",\"\r\n") == std::string::npos);
    }
    RC_ASSERT(field == text);
  }));
}

TEST(Latency, QuantilesRiseAndLieBetweenZeroAndTheMaximum) {
  EXPECT_TRUE(rc::check([] {
    LatencyHistogram latency;
    const auto exponents = *rc::gen::container<std::vector<double>>(any_between(-8, 5));
    for (const double exponent : exponents) latency.add(std::pow(10, exponent));
    double previous = 0;
    for (double q = 0; q <= 1; q += 0.125) {
      const double quantile = latency.quantile_s(q);
      RC_ASSERT(quantile >= previous);
      RC_ASSERT(quantile <= latency.max_s());
      previous = quantile;
    }
  }));
}

TEST(GraphG2o, CostsTheSameAsTheMeasuredPoseAtAnyPose) {
  EXPECT_TRUE(rc::check([] {
    const Pose measured = arbitrary_pose(10);
    Relation relation;
    relation.measurement = RelativePose{measured, arbitrary_information()};
    const Pose at = measured * Pose{*any_between(-1, 1), *any_between(-1, 1), *any_between(-0.5, 0.5)};
    const G2oEdge edge = g2o_edge(relation, measured);
    const Eigen::Vector3d error = to_vector(inverse(edge.measured_a_from_b) * at);
    const double wanted = cost(relation.measurement, at);
    RC_ASSERT(std::abs(0.5 * error.dot(edge.information * error) - wanted) <= 1e-7 * (1 + wanted));
  }));
}

TEST(GraphG2o, AnEdgeReadBackIsTheMeasurement) {
  EXPECT_TRUE(rc::check([] {
    const RelativePose measurement{arbitrary_pose(10), arbitrary_information()};
    Relation relation;
    relation.measurement = measurement;
    const RelativePose back = relative_pose(g2o_edge(relation, measurement.a_from_b));
    RC_ASSERT((back.information - measurement.information).norm() <= 1e-9 * measurement.information.norm());
    RC_ASSERT((to_vector(back.a_from_b) - to_vector(measurement.a_from_b)).norm() < 1e-9);
  }));
}

/// A map of one patch: a star of 24 beams of any lengths, some without return.
MapCopy arbitrary_star_map() {
  Scan scan{1, -3, 0.25, {}};
  for (int beam = 0; beam < 24; ++beam) scan.ranges_m.push_back(static_cast<float>(*any_between(-0.5, 5)));
  MapCopy map;
  map.patches = {make_patch(PatchId{0}, "R1", scan, Laser{{0.2, 0.1, 0.4}, 0.05, 4.5}, {})};
  map.poses = {arbitrary_pose(50)};
  map.graph.add_patch(PatchId{0});
  return map;
}

TEST(Grid, FreeCellsAreThoseWhoseCentreThePatchesFreeSpaceContains) {
  EXPECT_TRUE(rc::check([] {
    const MapCopy map = arbitrary_star_map();
    const OccupancyGrid grid = render_island(map, {PatchId{0}}, 0.1);
    const Patch& patch = *map.patches[0];
    std::size_t pixel = 0;
    for (int row = grid.height - 1; row >= 0; --row) {
      for (int column = 0; column < grid.width; ++column, ++pixel) {
        if (grid.pixels[pixel] == OccupancyGrid::occupied) continue;
        const Eigen::Vector2d centre(grid.origin_x_m + (column + 0.5) * grid.resolution_m,
                                     grid.origin_y_m + (row + 0.5) * grid.resolution_m);
        const bool inside = contains(patch.free_space, inverse(map.poses[0]) * centre);
        RC_ASSERT(inside == (grid.pixels[pixel] == OccupancyGrid::free));
      }
    }
  }));
}

TEST(Grid, EveryHitOfASinglePatchIsOccupied) {
  EXPECT_TRUE(rc::check([] {
    const MapCopy map = arbitrary_star_map();
    const OccupancyGrid grid = render_island(map, {PatchId{0}}, 0.05);
    for (const ScanPoint& point : map.patches[0]->points) {
      const Eigen::Vector2d at = map.poses[0] * point.position;
      const int column = static_cast<int>(std::floor((at.x() - grid.origin_x_m) / grid.resolution_m + 1e-9));
      const int row = static_cast<int>(std::floor((at.y() - grid.origin_y_m) / grid.resolution_m + 1e-9));
      RC_ASSERT((column > 0 && column < grid.width - 1 && row > 0 && row < grid.height - 1));
      const auto top_row = static_cast<std::size_t>(grid.height - 1 - row);
      const auto pixel =
          grid.pixels[top_row * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(column)];
      RC_ASSERT(pixel == OccupancyGrid::occupied);
    }
  }));
}

}  // namespace
}  // namespace isthmus
