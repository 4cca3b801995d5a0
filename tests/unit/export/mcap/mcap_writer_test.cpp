#include "tools/export/mcap/mcap_writer.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/support/temporary_directory.hpp"
#include "tests/unit/export/mcap/mcap_file.hpp"

namespace isthmus {
namespace {

using testing::McapFile;
using testing::read_mcap;

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

/// Two topics of one schema and a third; a message on each every second, of so many bytes.
std::string three_topics(const std::string& path, int seconds, std::size_t bytes) {
  McapWriter writer(path);
  const std::uint16_t a = writer.add_channel("/a", "Number", "{}");
  const std::uint16_t b = writer.add_channel("/b", "Number", "{}");
  for (int i = 0; i < seconds; ++i) {
    const auto time_ns = static_cast<std::uint64_t>(i + 1) * 1'000'000'000;
    writer.write(a, time_ns, std::string(bytes, static_cast<char>('a' + i % 26)));
    writer.write(b, time_ns + 1, "{}");
  }
  writer.write(writer.add_channel("/late", "Other", "{\"type\":\"object\"}"), 500'000'000, "{}");
  writer.finish();
  return bytes_of(path);
}

TEST(McapWriter, AFileIsReadByItsIndex) {
  const TemporaryDirectory directory;
  const McapFile file = read_mcap(three_topics(directory / "a.mcap", 100, 50'000));
  EXPECT_EQ(file.messages.size(), 201U);
  EXPECT_GT(file.chunks.size(), 4U);  // a megabyte each
  for (const McapFile::Chunk& chunk : file.chunks)
    EXPECT_LT(chunk.bytes, 100'000U) << "the same letter over and over is little";
  EXPECT_EQ(file.first_ns, 500'000'000U);
  EXPECT_EQ(file.last_ns, 100'000'000'001U);
  EXPECT_EQ(file.schemas.size(), 2U);  // the same schema once
  ASSERT_EQ(file.channels.size(), 3U);
  const auto of_a = file.of_topic("/a");
  ASSERT_EQ(of_a.size(), 100U);
  for (std::uint32_t i = 0; i < of_a.size(); ++i) {
    EXPECT_EQ(of_a[i].sequence, i);
    EXPECT_EQ(of_a[i].data, std::string(50'000, static_cast<char>('a' + i % 26)));
  }
}

TEST(McapWriter, MessagesOfAChunkAreIndexedInOrderOfTime) {
  const TemporaryDirectory directory;
  McapWriter writer(directory / "a.mcap");
  const std::uint16_t channel = writer.add_channel("/a", "Number", "{}");
  for (const std::uint64_t time_ns : {5U, 3U, 9U, 1U}) writer.write(channel, time_ns, "{}");
  writer.finish();
  const McapFile file = read_mcap(bytes_of(directory / "a.mcap"));  // checks the order
  EXPECT_EQ(file.messages.size(), 4U);
  EXPECT_EQ(file.first_ns, 1U);
  EXPECT_EQ(file.last_ns, 9U);
}

TEST(McapWriter, AFileWithoutMessagesIsWhole) {
  const TemporaryDirectory directory;
  McapWriter writer(directory / "a.mcap");
  writer.add_channel("/a", "Number", "{}");
  writer.finish();
  EXPECT_TRUE(read_mcap(bytes_of(directory / "a.mcap")).messages.empty());
}

TEST(McapWriter, NothingIsLeftOfAFileThatWasNotFinished) {
  const TemporaryDirectory directory;
  {
    McapWriter writer(directory / "a.mcap");
    const std::uint16_t channel = writer.add_channel("/a", "Number", "{}");
    for (std::uint64_t i = 0; i < 100; ++i) writer.write(channel, i, std::string(100'000, 'x'));
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory / ""));
}

TEST(McapWriter, AFileThatCannotBeWrittenIsAnErrorThatNamesIt) {
  try {
    McapWriter("/nowhere/a.mcap").finish();
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/a.mcap"), std::string::npos);
  }
}

TEST(McapWriter, ItsReaderNoticesWhatIsCutOffOrChanged) {
  const TemporaryDirectory directory;
  const std::string whole = three_topics(directory / "a.mcap", 3, 10);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THROW(read_mcap(whole.substr(0, size)), std::runtime_error) << size;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    EXPECT_THROW(read_mcap(changed), std::exception) << at;
  }
}

}  // namespace
}  // namespace isthmus
