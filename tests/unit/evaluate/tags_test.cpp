#include "tools/evaluate/tags.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

TEST(Tags, ThoseWithoutAPlaceAreLeftOut) {
  const TemporaryDirectory directory;
  const auto tags = read_placed_tags(directory.write("tags.csv",
                                                     "barcode,island,x_m,y_m,cov_x_x,cov_x_y,cov_y_y\n"
                                                     "7,1,0.5,-2,0.1,0,0.1\n8,-1,nan,nan,nan,nan,nan\n"));
  ASSERT_EQ(tags.size(), 1U);
  EXPECT_EQ(tags.at(7).island, 1);
  EXPECT_EQ(tags.at(7).position, Eigen::Vector2d(0.5, -2));
}

TEST(Tags, ErrorsNameFileAndLine) {
  const TemporaryDirectory directory;
  const auto placed = directory.write("placed.csv", "barcode,island,x_m,y_m\n7,1,nan,2\n");
  EXPECT_EQ(error_of([&] { read_placed_tags(placed); }), placed + ":2: not finite in column x_m");
  const auto truth = directory.write("truth.csv", "barcode,x_m,y_m\n7,1,2\n7,1,2\n");
  EXPECT_EQ(error_of([&] { read_true_tags(truth); }), truth + ":3: barcode 7 twice");
}

}  // namespace
}  // namespace isthmus
