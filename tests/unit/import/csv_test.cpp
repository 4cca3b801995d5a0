#include "tools/text/csv.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

TEST(Csv, ColumnsAreFoundByName) {
  const TemporaryDirectory directory;
  CsvReader csv(directory.write("a.csv", "# note\nb,a\r\n\n2, 1 \r\n"));
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(csv.integer("a"), 1);
  EXPECT_EQ(csv.integer("b"), 2);
  EXPECT_FALSE(csv.has_column("c"));
  EXPECT_FALSE(csv.next());
}

TEST(Csv, QuotedFieldsKeepTheirCommas) {
  EXPECT_EQ(split_csv_line("1,\"POLYGON ((0 0, 1 \"\"1\"\"))\",x"),
            (std::vector<std::string>{"1", "POLYGON ((0 0, 1 \"1\"))", "x"}));
  EXPECT_FALSE(split_csv_line("1,\"open"));
}

TEST(Csv, ErrorsNameFileLineAndReason) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("a.csv", "a,b\n1,2\n1\n1,x\n1,inf\n");
  CsvReader csv(file);
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(error_of([&] { csv.next(); }), file + ":3: wrong count of fields: 1 instead of 2");
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(error_of([&] { csv.number("b"); }), file + ":4: not a number in column b: 'x'");
  EXPECT_EQ(error_of([&] { csv.text("c"); }), file + ":4: no column 'c' in the header");
  ASSERT_TRUE(csv.next());
  EXPECT_EQ(error_of([&] { csv.finite("b"); }), file + ":5: not finite in column b");
}

TEST(Csv, AFileWithoutHeaderIsAnError) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("a.csv", "\n# only a note\n");
  EXPECT_EQ(error_of([&] { CsvReader csv(file); }), file + ": no header line");
}

}  // namespace
}  // namespace isthmus
