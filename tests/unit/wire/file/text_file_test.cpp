#include "server/wire/file/text_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

TEST(TextFile, IsReadWhole) {
  const TemporaryDirectory directory;
  const std::string long_text(200'000, 'x');
  EXPECT_EQ(read_text_file(directory.write("long", long_text)), long_text);
  EXPECT_EQ(read_text_file(directory.write("empty", "")), "");
}

TEST(TextFile, IsNoDirectoryPipeOrDevice) {
  const TemporaryDirectory directory;
  const auto error = [](const std::string& path) { return error_of([&] { read_text_file(path); }); };
  fs::create_directory(directory / "d");
  EXPECT_EQ(error(directory / "d"), directory / "d" + ": is a directory; give the file");
  ASSERT_EQ(::mkfifo((directory / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(error(directory / "pipe"), directory / "pipe" + ": is no regular file");
  EXPECT_EQ(error("/dev/null"), "/dev/null: is no regular file");
  EXPECT_EQ(error(directory / "none"), directory / "none" + ": cannot be read: No such file or directory");
}

TEST(KeyFile, MayBeWrittenByNobodyElseAndShouldNotBeRead) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("key", "");
  const auto allow = [&](unsigned mode) { fs::permissions(file, static_cast<fs::perms>(mode)); };
  allow(0600);
  EXPECT_EQ(check_key_file(file), "");
  allow(0660);
  EXPECT_EQ(check_key_file(file), "") << "a group of one's own is usual";
  allow(0644);
  EXPECT_EQ(check_key_file(file), file + ": holds keys, and anybody may read it: chmod 600 " + file);
  for (const unsigned mode : {0602U, 0666U}) {
    allow(mode);
    EXPECT_EQ(error_of([&] { check_key_file(file); }),
              file + ": holds keys, and anybody may write it: chmod 600 " + file);
  }
}

}  // namespace
}  // namespace isthmus
