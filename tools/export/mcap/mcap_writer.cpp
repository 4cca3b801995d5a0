#include "tools/export/mcap/mcap_writer.hpp"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <concepts>
#include <stdexcept>

namespace isthmus {
namespace {

constexpr std::string_view magic("\x89MCAP0\r\n", 8);
constexpr std::string_view compression = "zstd";
constexpr std::size_t chunk_bytes = 1 << 20;  ///< before compression

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

/// Little-endian.
template <std::unsigned_integral Number>
std::string bytes_of(Number number) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof number; ++i) bytes += static_cast<char>(number >> (8 * i) & 0xFF);
  return bytes;
}

/// With its length before it, as strings, arrays and maps are written.
template <std::unsigned_integral Length>
std::string counted(std::string_view bytes) {
  return bytes_of(static_cast<Length>(bytes.size())) + std::string(bytes);
}
std::string text(std::string_view bytes) { return counted<std::uint32_t>(bytes); }

std::string record(Opcode opcode, std::string_view content) {
  return static_cast<char>(opcode) + counted<std::uint64_t>(content);
}

std::uint32_t crc(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string compressed(std::string_view bytes) {
  std::string packed(::ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ::ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), ZSTD_CLEVEL_DEFAULT);
  if (::ZSTD_isError(size) != 0) throw std::runtime_error(std::string("zstd: ") + ::ZSTD_getErrorName(size));
  packed.resize(size);
  return packed;
}

/// Where records of one kind are in the summary; nothing of a kind that has none.
std::string summary_offset(Opcode opcode, std::uint64_t start, std::uint64_t length) {
  if (length == 0) return "";
  return record(Opcode::summary_offset,
                bytes_of(static_cast<std::uint8_t>(opcode)) + bytes_of(start) + bytes_of(length));
}

}  // namespace

void McapWriter::Times::include(std::uint64_t time_ns) {
  first_ns = any ? std::min(first_ns, time_ns) : time_ns;
  last_ns = any ? std::max(last_ns, time_ns) : time_ns;
  any = true;
}

McapWriter::McapWriter(const std::string& path) : file_(path) {
  put(magic);
  put(record(Opcode::header, text("") + text("isthmus")));
}

void McapWriter::put(std::string_view bytes) {
  file_.write(bytes);
  offset_ += bytes.size();
  data_crc_ = crc(bytes, data_crc_);
}

std::uint16_t McapWriter::add_channel(const std::string& topic, const std::string& schema_name,
                                      const std::string& schema) {
  end_chunk();
  const auto [known, is_new] =
      schema_ids_.emplace(schema_name, static_cast<std::uint16_t>(schema_ids_.size() + 1));
  if (is_new) {
    const std::string one = record(
        Opcode::schema, bytes_of(known->second) + text(schema_name) + text("jsonschema") + text(schema));
    put(one);
    schemas_ += one;
  }
  const auto id = static_cast<std::uint16_t>(sequences_.size());
  const std::string one =
      record(Opcode::channel, bytes_of(id) + bytes_of(known->second) + text(topic) + text("json") + text(""));
  put(one);
  channels_ += one;
  sequences_[id] = 0;
  statistics_.of_channel[id] = 0;
  return id;
}

void McapWriter::write(std::uint16_t channel, std::uint64_t log_time_ns, std::string_view json) {
  chunk_index_[channel].push_back({log_time_ns, chunk_.size()});
  chunk_ += record(Opcode::message, bytes_of(channel) + bytes_of(sequences_.at(channel)++) +
                                        bytes_of(log_time_ns) + bytes_of(log_time_ns) + std::string(json));
  chunk_times_.include(log_time_ns);
  statistics_.times.include(log_time_ns);
  ++statistics_.messages;
  ++statistics_.of_channel[channel];
  if (chunk_.size() >= chunk_bytes) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  const std::uint64_t start = offset_, size = chunk_.size();
  const std::string times = bytes_of(chunk_times_.first_ns) + bytes_of(chunk_times_.last_ns);
  const std::string packed = compressed(chunk_);
  put(record(Opcode::chunk, times + bytes_of(size) + bytes_of(crc(chunk_)) + text(compression) +
                                counted<std::uint64_t>(packed)));
  const std::uint64_t length = offset_ - start;
  std::string offsets;
  for (auto& [channel, entries] : chunk_index_) {
    std::ranges::stable_sort(entries, {}, &IndexEntry::time_ns);
    std::string list;
    for (const IndexEntry& entry : entries) list += bytes_of(entry.time_ns) + bytes_of(entry.offset);
    offsets += bytes_of(channel) + bytes_of(offset_);
    put(record(Opcode::message_index, bytes_of(channel) + counted<std::uint32_t>(list)));
  }
  chunk_indexes_ += record(Opcode::chunk_index, times + bytes_of(start) + bytes_of(length) +
                                                    counted<std::uint32_t>(offsets) +
                                                    bytes_of(offset_ - start - length) + text(compression) +
                                                    bytes_of(std::uint64_t{packed.size()}) + bytes_of(size));
  ++statistics_.chunks;
  chunk_.clear();
  chunk_index_.clear();
  chunk_times_ = {};
}

std::string McapWriter::statistics_record() const {
  std::string of_channel;
  for (const auto& [channel, messages] : statistics_.of_channel)
    of_channel += bytes_of(channel) + bytes_of(messages);
  constexpr std::uint32_t attachments = 0, metadata = 0;
  return record(Opcode::statistics,
                bytes_of(statistics_.messages) + bytes_of(static_cast<std::uint16_t>(schema_ids_.size())) +
                    bytes_of(static_cast<std::uint32_t>(sequences_.size())) + bytes_of(attachments) +
                    bytes_of(metadata) + bytes_of(statistics_.chunks) + bytes_of(statistics_.times.first_ns) +
                    bytes_of(statistics_.times.last_ns) + counted<std::uint32_t>(of_channel));
}

/// Summary and, at its end, the footer.
std::string McapWriter::summary(std::uint64_t start) const {
  std::string all, groups;
  const auto add = [&](Opcode opcode, const std::string& records) {
    groups += summary_offset(opcode, start + all.size(), records.size());
    all += records;
  };
  add(Opcode::schema, schemas_);
  add(Opcode::channel, channels_);
  add(Opcode::statistics, statistics_record());
  add(Opcode::chunk_index, chunk_indexes_);
  const std::uint64_t groups_start = start + all.size();
  constexpr std::uint64_t footer_bytes = 20;
  all += groups + static_cast<char>(Opcode::footer) + bytes_of(footer_bytes) + bytes_of(start) +
         bytes_of(groups_start);
  return all + bytes_of(crc(all));
}

void McapWriter::finish() {
  end_chunk();
  put(record(Opcode::data_end, bytes_of(data_crc_)));
  put(summary(offset_));
  put(magic);
  file_.commit();
}

}  // namespace isthmus
