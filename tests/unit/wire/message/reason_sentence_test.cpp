#include "server/wire/message/reason_sentence.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

TEST(ReasonSentence, OneWordMeansOfAnOrderAndOfAQuestionWhatItMeansThere) {
  EXPECT_EQ(sentence_of_order("bad_polygon"), "its sides cross or touch, or it has no area");
  EXPECT_EQ(sentence_of_order("unknown_patch"), "the map has changed meanwhile: draw it again");
  EXPECT_EQ(sentence_of_question("unknown_patch"), "no such patch is on the map");
  EXPECT_EQ(sentence_of_order("forged"), sentence_of_question("forged"));
  EXPECT_NE(sentence_of_order("unknown_robot"), sentence_of_question("unknown_robot"));
}

TEST(ReasonSentence, AReasonOfWhichNoMoreCanBeSaidStandsAlone) {
  EXPECT_EQ(sentence_of_order("stale_stamp"), "");
  EXPECT_EQ(sentence_of_order(""), "");
  EXPECT_EQ(with_sentence("stale_stamp", sentence_of_order("stale_stamp")), "stale_stamp");
  EXPECT_EQ(with_sentence("frozen", sentence_of_order("frozen")), "frozen: the map is frozen");
}

}  // namespace
}  // namespace isthmus
