#include "server/output/format/atomic_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "server/output/output.hpp"
#include "tests/unit/output/room.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;
using testing::content;
using testing::TemporaryDirectory;

std::size_t files_in(const std::string& directory) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory), fs::directory_iterator()));
}

/// The message of the std::runtime_error that `action` throws; empty where it throws none.
template <class Action>
std::string error_of(Action action) {
  try {
    action();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return {};
}

TEST(AtomicFile, IsThereWholeAfterCommit) {
  const TemporaryDirectory directory;
  AtomicFile file(directory.file("a.txt"));
  const std::string large(300'000, 'x');
  file.write("head ");
  file.write(large);
  EXPECT_FALSE(fs::exists(directory.file("a.txt"))) << "not before the commit";
  file.commit();
  EXPECT_EQ(content(directory.file("a.txt")), "head " + large);
  EXPECT_EQ(files_in(directory.path()), 1u) << "no temporary file is left";
}

TEST(AtomicFile, LeavesTheOldFileAndNoTraceWithoutCommit) {
  const TemporaryDirectory directory;
  AtomicFile old(directory.file("a.txt"));
  old.write("old");
  old.commit();
  {
    AtomicFile half(directory.file("a.txt"));
    half.write(std::string(300'000, 'x'));
  }
  EXPECT_EQ(content(directory.file("a.txt")), "old");
  EXPECT_EQ(files_in(directory.path()), 1u);
}

TEST(AtomicFile, AMissingDirectoryIsAnErrorThatNamesTheFileAndTheReason) {
  const TemporaryDirectory directory;
  const std::string file = directory.file("missing/a.txt");
  const std::string error = error_of([&] { AtomicFile{file}; });
  EXPECT_NE(error.find(file), std::string::npos) << error;
  EXPECT_NE(error.find("No such file or directory"), std::string::npos) << error;
}

TEST(AtomicFile, ADirectoryInTheFilesPlaceIsAnErrorAndLeavesNothing) {
  const TemporaryDirectory directory;
  fs::create_directory(directory.file("a.txt"));
  const std::string error = error_of([&] {
    AtomicFile file(directory.file("a.txt"));
    file.write("content");
    file.commit();
  });
  EXPECT_NE(error.find("a.txt"), std::string::npos) << error;
  EXPECT_EQ(files_in(directory.path()), 1u);
}

TEST(AtomicFile, AFullDiskIsAnErrorThatNamesTheFile) {
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "no /dev/full here";
  const TemporaryDirectory directory;
  // The temporary name leads to a disk that is always full.
  fs::create_symlink("/dev/full", directory.file("a.txt.tmp-" + std::to_string(::getpid())));
  const std::string error = error_of([&] {
    AtomicFile file(directory.file("a.txt"));
    file.write(std::string(300'000, 'x'));
    file.commit();
  });
  EXPECT_NE(error.find("a.txt: cannot be written: No space left on device"), std::string::npos) << error;
  EXPECT_EQ(files_in(directory.path()), 0u);
}

TEST(WriteOutputs, ADirectoryThatCannotBeMadeIsAClearError) {
  const TemporaryDirectory directory;
  AtomicFile file(directory.file("taken"));
  file.commit();
  const MapCopy map = testing::map_of({}, {});
  const std::string error = error_of([&] { write_outputs(map, {}, directory.file("taken/out")); });
  EXPECT_NE(error.find("taken/out"), std::string::npos) << error;
  EXPECT_EQ(files_in(directory.path()), 1u);
}

TEST(WriteOutputs, AReadOnlyDirectoryIsAClearErrorAndStaysEmpty) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  const TemporaryDirectory directory;
  fs::create_directories(directory.file("out/trajectories"));
  fs::permissions(directory.file("out"), fs::perms::owner_read | fs::perms::owner_exec);
  const MapCopy map = testing::map_of(testing::rectangle(0, 0, 4, 4), {{2, 2, 0}});
  const std::string error = error_of([&] { write_outputs(map, {}, directory.file("out")); });
  EXPECT_NE(error.find("island-0.pgm: cannot be written: Permission denied"), std::string::npos) << error;
  EXPECT_EQ(files_in(directory.file("out")), 1u);
  fs::permissions(directory.file("out"), fs::perms::owner_all);
}

}  // namespace
}  // namespace isthmus
