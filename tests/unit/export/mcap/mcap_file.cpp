#include "tests/unit/export/mcap/mcap_file.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <functional>
#include <stdexcept>

namespace isthmus::testing {
namespace {

void check(bool good, const char* what) {
  if (!good) throw std::runtime_error(what);
}

std::uint32_t crc(std::string_view bytes) {
  return static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

/// Of exactly so many bytes.
std::string unpacked(std::string_view packed, std::uint64_t size) {
  check(::ZSTD_getFrameContentSize(packed.data(), packed.size()) == size, "unpacks to another size");
  std::string bytes(size, '\0');
  const std::size_t got = ::ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  check(::ZSTD_isError(got) == 0 && got == size, "cannot be unpacked");
  return bytes;
}

class Fields {
 public:
  explicit Fields(std::string_view bytes) : bytes_(bytes) {}

  template <class Number>
  Number number() {
    const std::string_view taken = take(sizeof(Number));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < taken.size(); ++i)
      value |= static_cast<std::uint64_t>(static_cast<unsigned char>(taken[i])) << (8 * i);
    return static_cast<Number>(value);
  }
  std::uint16_t u16() { return number<std::uint16_t>(); }
  std::uint32_t u32() { return number<std::uint32_t>(); }
  std::uint64_t u64() { return number<std::uint64_t>(); }
  std::string_view take(std::uint64_t size) {
    check(size <= bytes_.size(), "cut off");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }
  std::string text() { return std::string(take(u32())); }
  std::string_view rest() { return take(bytes_.size()); }
  bool empty() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

struct Record {
  int opcode = 0;
  std::string_view content;
};

Record next_record(Fields& fields) {
  Record record;
  record.opcode = fields.number<std::uint8_t>();
  record.content = fields.take(fields.u64());
  return record;
}

constexpr std::string_view magic("\x89MCAP0\r\n", 8);
constexpr std::size_t footer_bytes = 1 + 8 + 8 + 8 + 4;

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  McapFile read() {
    check(bytes_.size() > 2 * magic.size() + footer_bytes, "too short");
    check(bytes_.starts_with(magic) && bytes_.ends_with(magic), "no magic at both ends");
    Fields end(std::string_view(bytes_).substr(bytes_.size() - magic.size() - footer_bytes));
    const Record footer = next_record(end);
    check(footer.opcode == 2, "no footer");
    Fields fields(footer.content);
    const std::uint64_t summary = fields.u64(), offsets = fields.u64();
    const std::size_t crc_at = bytes_.size() - magic.size() - 4;
    check(summary > 0 && summary < offsets && offsets < crc_at, "no summary");
    check(crc(part(summary, crc_at - summary)) == fields.u32(), "the summary's CRC is wrong");
    read_summary(summary, offsets);
    read_offsets(offsets, bytes_.size() - magic.size() - footer_bytes);
    read_data(summary);
    return std::move(file_);
  }

 private:
  std::string_view part(std::uint64_t from, std::uint64_t size) const {
    check(from <= bytes_.size() && size <= bytes_.size() - from, "an offset beyond the end");
    return std::string_view(bytes_).substr(from, size);
  }

  void read_summary(std::uint64_t from, std::uint64_t to) {
    Fields fields(part(from, to - from));
    while (!fields.empty()) {
      const Record record = next_record(fields);
      Fields content(record.content);
      if (record.opcode == 3) read_schema(content);
      if (record.opcode == 4) read_channel(content);
      if (record.opcode == 8) read_chunk(content);
      if (record.opcode == 11) read_statistics(content);
    }
    check(statistics_seen_, "no statistics");
    check(file_.counted_messages == file_.messages.size(), "the statistics count other messages");
    check(of_channel_ == seen_of_channel_, "the statistics count other messages of a channel");
  }

  /// Each group of records begins and ends where the summary's offsets say.
  void read_offsets(std::uint64_t from, std::uint64_t to) {
    Fields fields(part(from, to - from));
    while (!fields.empty()) {
      const Record record = next_record(fields);
      check(record.opcode == 14, "another record among the summary's offsets");
      Fields content(record.content);
      const int opcode = content.number<std::uint8_t>();
      const std::uint64_t start = content.u64(), length = content.u64();
      Fields group(part(start, length));
      while (!group.empty()) check(next_record(group).opcode == opcode, "another record in a group");
    }
  }

  void read_schema(Fields& fields) {
    const std::uint16_t id = fields.u16();
    check(id > 0 && !file_.schemas.contains(id), "schema 0, or one twice");
    McapFile::Schema& schema = file_.schemas[id];
    schema.name = fields.text();
    schema.encoding = fields.text();
    schema.text = fields.text();
  }

  void read_channel(Fields& fields) {
    const std::uint16_t id = fields.u16();
    McapFile::Channel& channel = file_.channels[id];
    channel.schema = fields.u16();
    channel.topic = fields.text();
    channel.encoding = fields.text();
    check(fields.u32() == 0 && fields.empty(), "metadata of a channel");
    check(file_.schemas.contains(channel.schema), "a channel without its schema");
    seen_of_channel_[id] = 0;
  }

  void read_statistics(Fields& fields) {
    statistics_seen_ = true;
    file_.counted_messages = fields.u64();
    check(fields.u16() == file_.schemas.size(), "the statistics count other schemas");
    check(fields.u32() == file_.channels.size(), "the statistics count other channels");
    check(fields.u32() == 0 && fields.u32() == 0, "attachments or metadata");
    counted_chunks_ = fields.u32();
    file_.first_ns = fields.u64();
    file_.last_ns = fields.u64();
    Fields counts(fields.take(fields.u32()));
    while (!counts.empty()) {
      const std::uint16_t channel = counts.u16();
      of_channel_[channel] = counts.u64();
    }
  }

  /// A chunk by its index: the chunk itself, and the indexes of its messages behind it.
  void read_chunk(Fields& fields) {
    McapFile::Chunk chunk;
    chunk.first_ns = fields.u64();
    chunk.last_ns = fields.u64();
    const std::uint64_t start = fields.u64(), length = fields.u64();
    Fields offsets(fields.take(fields.u32()));
    const std::uint64_t index_length = fields.u64();
    check(fields.text() == "zstd", "compressed by something else");
    const std::uint64_t compressed = fields.u64(), size = fields.u64();
    Fields at(part(start, length));
    const Record record = next_record(at);
    check(record.opcode == 6 && at.empty(), "no chunk where its index has it");
    Fields content(record.content);
    check(content.u64() == chunk.first_ns && content.u64() == chunk.last_ns, "other times in the chunk");
    check(content.u64() == size, "another size in the chunk");
    const std::uint32_t expected_crc = content.u32();
    check(content.text() == "zstd", "compressed by something else than its index says");
    const std::string_view packed = content.take(content.u64());
    check(packed.size() == compressed, "another compressed size in the chunk");
    const std::string records = unpacked(packed, size);
    check(crc(records) == expected_crc, "the CRC of a chunk is wrong");
    chunk.bytes = packed.size();
    read_messages(records, chunk);
    std::size_t indexed = 0;
    while (!offsets.empty()) {
      const std::uint16_t channel = offsets.u16();
      indexed += check_index(channel, offsets.u64(), {start + length, index_length}, records);
    }
    check(indexed == chunk.messages, "messages that no index has");
    file_.chunks.push_back(chunk);
  }

  void read_messages(std::string_view records, McapFile::Chunk& chunk) {
    Fields fields(records);
    std::uint64_t first_ns = UINT64_MAX, last_ns = 0;
    while (!fields.empty()) {
      const Record record = next_record(fields);
      check(record.opcode == 5, "a chunk of something else than messages");
      McapFile::Message message = message_of(record);
      first_ns = std::min(first_ns, message.log_time_ns);
      last_ns = std::max(last_ns, message.log_time_ns);
      seen_of_channel_[message.channel] += 1;
      file_.messages.push_back(std::move(message));
      ++chunk.messages;
    }
    check(first_ns == chunk.first_ns && last_ns == chunk.last_ns, "other times of messages");
  }

  static McapFile::Message message_of(const Record& record) {
    Fields fields(record.content);
    McapFile::Message message;
    message.channel = fields.u16();
    message.sequence = fields.u32();
    message.log_time_ns = fields.u64();
    check(fields.u64() == message.log_time_ns, "published at another time");
    message.data = std::string(fields.rest());
    return message;
  }

  struct Range {
    std::uint64_t start = 0, length = 0;
  };
  /// How many messages the index of a channel names; each is where it says.
  std::size_t check_index(std::uint16_t channel, std::uint64_t offset, Range indexes,
                          std::string_view records) const {
    check(offset >= indexes.start && offset < indexes.start + indexes.length, "an index elsewhere");
    Fields at(part(offset, indexes.start + indexes.length - offset));
    const Record record = next_record(at);
    check(record.opcode == 7, "no message index where the chunk's has it");
    Fields fields(record.content);
    check(fields.u16() == channel, "the index of another channel");
    Fields entries(fields.take(fields.u32()));
    std::size_t count = 0;
    for (std::uint64_t before_ns = 0; !entries.empty(); ++count) {
      const std::uint64_t time_ns = entries.u64(), message_offset = entries.u64();
      check(time_ns >= before_ns && message_offset < records.size(), "an index out of order");
      before_ns = time_ns;
      Fields message(records.substr(message_offset));
      const McapFile::Message found = message_of(next_record(message));
      check(found.channel == channel && found.log_time_ns == time_ns, "another message where one should be");
    }
    return count;
  }

  /// From the beginning on, as one reads a file that is still written.
  void read_data(std::uint64_t end) const {
    Fields fields(part(magic.size(), end - magic.size()));
    check(next_record(fields).opcode == 1, "no header");
    std::map<std::uint16_t, bool> channels_so_far;
    std::uint32_t chunks = 0;
    while (true) {
      const std::uint64_t offset = end - fields_left(fields);
      const Record record = next_record(fields);
      Fields content(record.content);
      if (record.opcode == 4) channels_so_far[content.u16()] = true;
      if (record.opcode == 6) chunks += 1;
      if (record.opcode == 7) check(channels_so_far.contains(content.u16()), "messages before their channel");
      if (record.opcode != 15) continue;
      check(content.u32() == crc(part(0, offset)), "the CRC of the data is wrong");
      check(fields.empty(), "data after their end");
      break;
    }
    check(chunks == counted_chunks_ && chunks == file_.chunks.size(), "other chunks than counted");
  }
  static std::uint64_t fields_left(Fields fields) { return fields.rest().size(); }

  const std::string& bytes_;
  McapFile file_;
  bool statistics_seen_ = false;
  std::uint32_t counted_chunks_ = 0;
  std::map<std::uint16_t, std::uint64_t> of_channel_, seen_of_channel_;
};

}  // namespace

McapFile read_mcap(const std::string& bytes) { return Reader(bytes).read(); }

}  // namespace isthmus::testing
