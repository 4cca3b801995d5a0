#include "tools/evaluate/failure.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

RelationErrors errors(std::size_t count, std::size_t missing) {
  RelationErrors errors;
  errors.count = count;
  errors.missing = missing;
  return errors;
}

TEST(EvaluationFailure, TruthThatNoRelationMatches) {
  Evaluation evaluation;
  evaluation.relations["intra"] = errors(0, 2984);
  EXPECT_NE(failure_of(evaluation), "");
  evaluation.relations["inter"] = errors(1, 7);
  EXPECT_EQ(failure_of(evaluation), "");
}

TEST(EvaluationFailure, TruthThatNoPoseMatches) {
  Evaluation evaluation;
  evaluation.absolute.emplace();
  EXPECT_NE(failure_of(evaluation), "");
  evaluation.absolute->islands.emplace_back();
  EXPECT_EQ(failure_of(evaluation), "");
}

TEST(EvaluationFailure, NoneWhereNothingWasCompared) { EXPECT_EQ(failure_of({}), ""); }

}  // namespace
}  // namespace isthmus
