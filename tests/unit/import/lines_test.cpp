#include "tools/text/lines.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

std::vector<std::string> all_lines(const std::string& file) {
  LineReader reader(file);
  std::vector<std::string> lines;
  while (const auto line = reader.next()) lines.emplace_back(*line);
  return lines;
}

std::string write_gz(const std::string& file, const std::string& content) {
  gzFile gz = gzopen(file.c_str(), "wb");
  gzwrite(gz, content.data(), static_cast<unsigned>(content.size()));
  gzclose(gz);
  return file;
}

/// Lines long enough to cross the reader's blocks, with content that does not compress away.
std::string long_text() {
  std::string text;
  unsigned state = 1;
  for (int i = 0; i < 2000; ++i) {
    for (int j = 0; j < i % 600; ++j)
      text += static_cast<char>('a' + (state = state * 1103515245 + 12345) / 65536 % 26);
    text += '\n';
  }
  return text;
}

TEST(Lines, EndsOfLinesAreTakenOff) {
  const TemporaryDirectory directory;
  EXPECT_EQ(all_lines(directory.write("a", "one\r\n\ntwo")), (std::vector<std::string>{"one", "", "two"}));
  EXPECT_EQ(all_lines(directory.write("b", "one\n")), (std::vector<std::string>{"one"}));
  EXPECT_TRUE(all_lines(directory.write("c", "")).empty());
}

TEST(Lines, GzReadsAsThePlainFile) {
  const TemporaryDirectory directory;
  const std::string text = long_text();
  const auto plain = all_lines(directory.write("a", text));
  EXPECT_EQ(plain.size(), 2000U);
  EXPECT_EQ(all_lines(write_gz(directory / "a.gz", text)), plain);
}

TEST(Lines, ATruncatedGzIsAnErrorAndNotAnEnd) {
  const TemporaryDirectory directory;
  const std::string file = write_gz(directory / "a.gz", long_text());
  const auto size = std::filesystem::file_size(file);
  for (const auto keep : {size / 2, size - 1, size - 8}) {
    std::filesystem::resize_file(file, keep);
    EXPECT_THROW(all_lines(file), TruncatedFile) << keep;
    write_gz(file, long_text());
  }
}

TEST(Lines, ADamagedGzIsAnError) {
  const TemporaryDirectory directory;
  const std::string file = write_gz(directory / "a.gz", long_text());
  {
    std::fstream bytes(file, std::ios::binary | std::ios::in | std::ios::out);
    bytes.seekp(static_cast<long>(std::filesystem::file_size(file) / 2));
    bytes << "damage damage damage";
  }
  EXPECT_NE(error_of([&] { all_lines(file); }).find("gz file"), std::string::npos);
}

TEST(Lines, WhatCannotBeOpenedNamesTheFile) {
  const TemporaryDirectory directory;
  const std::string missing = directory / "missing";
  EXPECT_EQ(error_of([&] { all_lines(missing); }), missing + ": No such file or directory");
  EXPECT_EQ(error_of([&] { all_lines(directory / ""); }), directory / "" + ": Is a directory");
}

}  // namespace
}  // namespace isthmus
