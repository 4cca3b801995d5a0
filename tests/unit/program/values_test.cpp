#include "server/program/values.hpp"

#include <gtest/gtest.h>

#include "server/program/option_tree.hpp"

namespace isthmus {
namespace {

std::string judged(const CLI::Validator& validator, std::string text) { return validator(text); }

TEST(Values, SayWhatWasGivenAndWhatIsAllowed) {
  EXPECT_EQ(judged(number_in(0.01, 100), "0.01"), "");
  EXPECT_EQ(judged(number_in(0.01, 100), "0"), "'0' is not a number from 0.01 to 100");
  EXPECT_EQ(judged(number_in(0, 1), "nan"), "'nan' is not a number from 0 to 1");
  EXPECT_EQ(judged(number_above(0), "0"), "'0' is not a number above 0");
  EXPECT_EQ(judged(number_from(0), "0"), "");
  EXPECT_EQ(judged(finite_number(), "inf"), "'inf' is not a number");
  EXPECT_EQ(judged(integer_in(2, 1'000'000), "2.5"), "'2.5' is not an integer from 2 to 1000000");
  EXPECT_EQ(judged(integer_from(1), "0"), "'0' is not an integer of at least 1");
}

TEST(Values, SuggestTheWordThatWasMeant) {
  EXPECT_EQ(judged(one_of({"debug", "info"}), "info"), "");
  EXPECT_EQ(judged(one_of({"debug", "info"}), "inof"), "'inof' is none of debug, info; did you mean 'info'?");
  EXPECT_EQ(judged(one_of({"debug", "info"}), "x"), "'x' is none of debug, info");
}

TEST(Values, AWordStandsForTheValueOfAnEnumeration) {
  enum class Colour { red = 3, green };
  const CLI::Validator colour =
      one_of(std::map<std::string, Colour>{{"green", Colour::green}, {"red", Colour::red}});
  std::string text = "red";
  EXPECT_EQ(colour(text), "");
  EXPECT_EQ(text, "3");
  EXPECT_EQ(judged(colour, "ren"), "'ren' is none of green, red; did you mean 'red'?");
}

TEST(Values, HaveReadableTypes) {
  CLI::App app;
  std::string text;
  double number = 0;
  std::vector<int> integers;
  unsigned count = 0;
  bool flag = false;
  EXPECT_EQ(value_text(*app.add_option("--text", text)), "TEXT");
  EXPECT_EQ(value_text(*app.add_option("--number", number)->check(number_in(0, 1))), "NUMBER (from 0 to 1)");
  EXPECT_EQ(value_text(*app.add_option("--integers", integers)), "INTEGER");
  EXPECT_EQ(value_text(*app.add_option("--count", count)), "INTEGER");
  EXPECT_EQ(value_text(*app.add_option("--word", text)->check(one_of({"a", "b"}))), "a|b");
  EXPECT_EQ(value_text(*app.add_option("--file", text)->type_name("FILE")), "FILE");
  EXPECT_EQ(value_text(*app.add_flag("--flag", flag)), "");
}

TEST(Values, OfNumbersAreReadByWhatTakesThem) {
  CLI::App app;
  int integer = 0;
  unsigned count = 0;
  app.add_subcommand("one")->add_option_group("group")->add_option("--integer", integer);
  app.add_option("--count", count);
  check_types(app);
  EXPECT_EQ(all_options_of(app).size(), 5U) << "three of them --help";
  EXPECT_THROW(app.parse("--count -1"), CLI::ValidationError);
  EXPECT_THROW(app.parse("one --integer 1.5"), CLI::ValidationError);
  EXPECT_NO_THROW(app.parse("one --integer -1"));
}

}  // namespace
}  // namespace isthmus
