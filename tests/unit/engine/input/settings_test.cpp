#include "server/engine/input/settings.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace isthmus {
namespace {

/// What is wrong with a text for a reader; empty: nothing.
std::string error_in(const std::string& toml, const std::function<void(Fields&)>& read) {
  try {
    const Setting root = parse_settings(toml, "s.toml");
    Fields fields(root, " in [tried]");
    read(fields);
    fields.finish();
  } catch (const SettingError& error) {
    return error.what();
  }
  return "";
}

TEST(Settings, AreReadByName) {
  bool truth = false;
  double number = 0, whole = 0, angle_rad = 0;
  std::string text;
  std::size_t count = 0;
  const std::string toml = "truth = true\nnumber = 0.5\nwhole = 3\ndeg = 180\ntext = \"t\"\ncount = 7\n";
  EXPECT_EQ(error_in(toml,
                     [&](Fields& fields) {
                       EXPECT_TRUE(fields.read("truth", truth));
                       EXPECT_TRUE(fields.read("number", number));
                       EXPECT_TRUE(fields.read_within("whole", whole, 0, 5));
                       EXPECT_TRUE(fields.read_degrees("deg", angle_rad));
                       EXPECT_TRUE(fields.read("text", text));
                       EXPECT_TRUE(fields.read_within("count", count, 0, 7));
                     }),
            "");
  EXPECT_TRUE(truth);
  EXPECT_EQ(number, 0.5);
  EXPECT_EQ(whole, 3) << "integers count as numbers";
  EXPECT_NEAR(angle_rad, 3.14159265, 1e-8);
  EXPECT_EQ(text, "t");
  EXPECT_EQ(count, 7U);
}

TEST(Settings, ThatAreAbsentChangeNothing) {
  double number = 1.5, angle_rad = 0.25;
  EXPECT_EQ(error_in("",
                     [&](Fields& fields) {
                       EXPECT_FALSE(fields.read_within("number", number, 0, 1));
                       EXPECT_FALSE(fields.read_degrees("deg", angle_rad));
                       EXPECT_EQ(fields.table("laser"), nullptr);
                     }),
            "");
  EXPECT_EQ(number, 1.5);
  EXPECT_EQ(angle_rad, 0.25);
}

TEST(Settings, OutOfBoundsAreRefusedWithTheirLine) {
  double number = 0;
  int count = 0;
  const auto read = [&](Fields& fields) {
    fields.read_within("number", number, 0, 1);
    fields.read_within("count", count, -1, 9);
  };
  EXPECT_EQ(error_in("\nnumber = 1.5", read), "s.toml:2: number = 1.5 is not within 0 to 1");
  EXPECT_EQ(error_in("number = nan", read), "s.toml:1: number = nan is not within 0 to 1");
  EXPECT_EQ(error_in("count = 10", read), "s.toml:1: count = 10 is not within -1 to 9");
  EXPECT_EQ(error_in("number = 1\ncount = 9", read), "");
}

TEST(Settings, OfAnotherTypeAreRefused) {
  double number = 0;
  int count = 0;
  EXPECT_EQ(error_in("number = true", [&](Fields& fields) { fields.read("number", number); }),
            "s.toml:1: number must be a number");
  EXPECT_EQ(error_in("number = inf", [&](Fields& fields) { fields.read("number", number); }),
            "s.toml:1: number must be finite");
  EXPECT_EQ(error_in("count = 1.0", [&](Fields& fields) { fields.read_within("count", count, 0, 9); }),
            "s.toml:1: count must be an integer");
  EXPECT_EQ(error_in("laser = 1", [](Fields& fields) { fields.table("laser"); }),
            "s.toml:1: laser must be a table");
  EXPECT_EQ(error_in("[x]\n", [](Fields& fields) { fields.require("y"); }), "s.toml:1: 'y' is missing");
  EXPECT_EQ(error_in("\nwhen = 1979-05-27", [](Fields&) {}),
            "s.toml:2: a date or a time has no meaning here");
}

TEST(Settings, ThatNobodyAskedForAreRefused) {
  double number = 0;
  EXPECT_EQ(error_in("number = 1\nnumbr = 2",
                     [&](Fields& fields) {
                       fields.read("number", number);
                       fields.find("other");
                     }),
            "s.toml:2: unknown key 'numbr' in [tried]; did you mean 'number'? (known: number, other)");
}

TEST(Settings, ListsHaveTheirLength) {
  const Setting root = parse_settings("pose = [1, 2.5, 3]\n", "s.toml");
  const Setting& pose = std::get<Setting::Table>(root.value).at("pose");
  EXPECT_EQ(as_numbers(pose, 3, "[x, y, yaw]"), (std::vector<double>{1, 2.5, 3}));
  EXPECT_THROW(as_numbers(pose, 2, "[x, y]"), SettingError);
  EXPECT_THROW(as_list(as_list(pose, "a list")[0], "a list"), SettingError);
}

}  // namespace
}  // namespace isthmus
