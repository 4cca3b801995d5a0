#include "server/wire/journal/frames/spool_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "isthmus/receipt_t.hpp"
#include "isthmus/spool_t.hpp"
#include "server/wire/file/file_bytes.hpp"
#include "server/wire/journal/frames/log_frame.hpp"
#include "server/wire/message/byte_check.hpp"
#include "server/wire/message/encoded.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

constexpr const char* header_channel = "ISTHMUS_SPOOL";
constexpr const char* receipt_channel = "ISTHMUS_RECEIPT";
constexpr std::string_view spool_prefix = "received-";
constexpr std::string_view spool_extension = ".spool";
constexpr std::array header_members = {fixed(4)};
constexpr std::array receipt_members = {text(64), text(64), fixed(8), fixed(4)};
constexpr std::size_t checksum_bytes = 4;

std::uint32_t crc_of(std::span<const std::uint8_t> receipt, std::span<const std::uint8_t> frame) {
  const std::size_t before_checksum = receipt.size() - checksum_bytes;
  const auto start = ::crc32_z(0, receipt.data(), before_checksum);
  return static_cast<std::uint32_t>(::crc32_z(start, frame.data(), frame.size()));
}

/// A whole frame of a file, its parts being views of the file's window.
struct Frame {
  LogHeader header;
  std::span<const std::uint8_t> bytes;  ///< all
  std::span<const std::uint8_t> data;
  std::string_view channel;
};

std::optional<Frame> frame_of(std::span<const std::uint8_t> bytes) {
  const std::optional<LogHeader> header = parse_log_header(bytes);
  if (!header || header->frame_bytes() > static_cast<std::int64_t>(bytes.size())) return std::nullopt;
  const auto channel = bytes.subspan(log_header_bytes, static_cast<std::size_t>(header->channel_bytes));
  const auto frame = bytes.first(static_cast<std::size_t>(header->frame_bytes()));
  return Frame{*header,
               frame,
               frame.subspan(log_header_bytes + channel.size()),
               {reinterpret_cast<const char*>(channel.data()), channel.size()}};
}

/// The bytes of the frame at an offset; fewer where the file ends before it does.
std::span<const std::uint8_t> frame_bytes_at(FileBytes& file, std::int64_t offset) {
  const auto start = file.at(offset, static_cast<std::int64_t>(log_header_bytes));
  const std::optional<LogHeader> header = parse_log_header(start);
  return header ? file.at(offset, header->frame_bytes()) : start;
}

template <class T>
std::optional<T> decoded(const Frame& frame, std::string_view channel, std::span<const Member> members) {
  T message{};
  const int size = static_cast<int>(frame.data.size());
  if (frame.channel != channel || check_bytes(T::getHash(), members, frame.data) != DropReason::none ||
      message.decode(frame.data.data(), 0, size) != size)
    return std::nullopt;
  return message;
}

/// The receipt and the message that begin the bytes; nothing where they are torn or damaged.
std::optional<Message> spooled_message(std::span<const std::uint8_t> bytes) {
  const std::optional<Frame> first = frame_of(bytes);
  if (!first) return std::nullopt;
  const std::optional<Frame> second = frame_of(bytes.subspan(first->bytes.size()));
  const auto receipt = decoded<receipt_t>(*first, receipt_channel, receipt_members);
  if (!second || !receipt || second->header.number != first->header.number) return std::nullopt;
  if (crc_of(first->data, second->bytes) != static_cast<std::uint32_t>(receipt->checksum))
    return std::nullopt;
  Message message{
      second->header.utime, std::string(second->channel), {second->data.begin(), second->data.end()}};
  message.received = second->header.number;
  if (!receipt->sender.empty())
    message.signature = Signature{receipt->sender, receipt->channel, receipt->counter};
  return message;
}

/// The bytes of the receipt and the message at an offset, as far as the file goes.
std::span<const std::uint8_t> spooled_bytes_at(FileBytes& file, std::int64_t offset) {
  const auto receipt = static_cast<std::int64_t>(frame_bytes_at(file, offset).size());
  const auto message = static_cast<std::int64_t>(frame_bytes_at(file, offset + receipt).size());
  return file.at(offset, receipt + message);
}

struct SpoolHeader {
  spool_t content{};
  std::int64_t bytes = 0;
};

std::optional<SpoolHeader> read_spool_header(FileBytes& file) {
  const std::optional<Frame> frame = frame_of(frame_bytes_at(file, 0));
  if (!frame) return std::nullopt;
  const auto content = decoded<spool_t>(*frame, header_channel, header_members);
  if (!content) return std::nullopt;
  return SpoolHeader{*content, frame->header.frame_bytes()};
}

/// The number in received-000000000012.spool; nothing where the name is not of that form.
std::optional<std::int64_t> number_of(const std::string& name) {
  if (!name.starts_with(spool_prefix) || !name.ends_with(spool_extension)) return std::nullopt;
  std::int64_t number = -1;
  std::from_chars(name.data() + spool_prefix.size(), name.data() + name.size(), number);
  const bool same = number >= 0 && fs::path(spool_path("", number)).filename() == name;
  return same ? std::optional(number) : std::nullopt;
}

}  // namespace

std::map<std::int64_t, std::string> list_spool(const std::string& directory) {
  std::map<std::int64_t, std::string> files;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end; entry.increment(error)) {
    if (const auto number = number_of(entry->path().filename().string()))
      files.emplace(*number, entry->path().string());
  }
  if (error) throw std::runtime_error(directory + ": " + error.message());
  return files;
}

std::string spool_path(const std::string& directory, std::int64_t first_number) {
  char digits[24];
  std::snprintf(digits, sizeof digits, "%012lld", static_cast<long long>(first_number));
  return (fs::path(directory) / (std::string(spool_prefix) + digits + std::string(spool_extension))).string();
}

void append_spool_header(std::vector<std::uint8_t>& out, std::int64_t first_number, int journal_segment) {
  spool_t header{};
  header.journal_segment = journal_segment;
  append_log_frame(out, first_number, {0, header_channel, encoded(header)});
}

void append_spooled(std::vector<std::uint8_t>& out, const Message& message) {
  receipt_t receipt{};
  if (message.signature) {
    receipt.sender = message.signature->sender;
    receipt.channel = message.signature->channel;
    receipt.counter = message.signature->counter;
  }
  const Message framed{message.utime, receipt_channel, encoded(receipt)};
  append_log_frame(out, message.received, framed);
  const std::size_t receipt_end = out.size();
  append_log_frame(out, message.received, message);
  const std::uint32_t crc = crc_of(framed.bytes, std::span(out).subspan(receipt_end));
  for (std::size_t i = 0; i < checksum_bytes; ++i)
    out[receipt_end - checksum_bytes + i] = static_cast<std::uint8_t>(crc >> (24 - 8 * i));
}

SpoolFileEnd read_spool_file(const std::string& path,
                             const std::function<void(Message&&, std::span<const std::uint8_t>)>& take) {
  FileBytes file(path);
  SpoolFileEnd end;
  if (const std::optional<SpoolHeader> header = read_spool_header(file)) {
    end.journal_segment = header->content.journal_segment;
    end.intact_bytes = header->bytes;
    while (end.intact_bytes < file.size()) {
      const auto bytes = spooled_bytes_at(file, end.intact_bytes);
      std::optional<Message> message = spooled_message(bytes);
      if (!message) break;
      take(std::move(*message), bytes);
      end.intact_bytes += static_cast<std::int64_t>(bytes.size());
    }
  }
  end.lost_bytes = file.size() - end.intact_bytes;
  return end;
}

int spool_journal_segment(const std::string& path) {
  FileBytes file(path);
  const std::optional<SpoolHeader> header = read_spool_header(file);
  return header ? header->content.journal_segment : 0;
}

std::optional<int> first_segment_of_spool(const std::string& directory) {
  std::optional<int> first;
  for (const auto& [number, path] : list_spool(directory)) {
    try {
      const int segment = spool_journal_segment(path);
      if (segment > 0) first = std::min(first.value_or(segment), segment);
    } catch (const std::runtime_error&) {
      if (fs::exists(path)) throw;  // the server may just have deleted it
    }
  }
  return first;
}

}  // namespace isthmus
