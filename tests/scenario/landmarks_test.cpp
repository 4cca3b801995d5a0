#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/recorded_data.hpp"
#include "tools/evaluate/landmark_maps.hpp"

namespace isthmus {
namespace {

std::string log_of(const std::string& name) { return data_directory() + "/features/" + name + ".txt.gz"; }

TEST(Landmarks, RecordedLogsAreMappedAsWellAsMeasured) {
  const std::string city = log_of("cityTrees10000"), park = log_of("victoriaPark");
  if (!std::filesystem::exists(city)) GTEST_SKIP() << "no recorded data at " << city << " (ISTHMUS_DATA)";
  const LandmarkEvaluation trees =
      evaluate_landmarks({city, log_of("cityTrees10000_truth"), LandmarkAssociation::known, 0});
  const LandmarkErrors& invariant = trees.rows[0].errors;
  EXPECT_LT(invariant.pose_rmse_m, 1.5);
  EXPECT_LT(invariant.pose_rmse_deg, 2.25);
  EXPECT_GT(invariant.nees_per_dof, 0.8);
  EXPECT_LT(invariant.nees_per_dof, 1.3);
  EXPECT_GT(trees.rows[1].errors.nees_per_dof, 10);  // the EKF as printed
  EXPECT_NEAR(trees.rows[2].map.chi_squared_per_dof, 0.998, 0.002);
  const LandmarkEvaluation victoria = evaluate_landmarks({park, "", LandmarkAssociation::known, 0});
  EXPECT_LT(victoria.rows[0].errors.landmark_rmse_m, 1.2);
  EXPECT_LT(victoria.rows[0].errors.landmark_aligned_m, 0.6);
}

}  // namespace
}  // namespace isthmus
