#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/wire/message/message.hpp"

namespace isthmus {

/// The files of a spool, received-000000000000.spool, ..., by the number of their first message.
std::map<std::int64_t, std::string> list_spool(const std::string& directory);
std::string spool_path(const std::string& directory, std::int64_t first_number);

/// How a file of the spool begins: no message of it is in a segment of the journal before this one.
void append_spool_header(std::vector<std::uint8_t>& out, std::int64_t first_number, int journal_segment);

/// A message of the spool: a receipt with its checksum and what a restart must know of its signature, and the
/// message as a log has it; both frames bear its number.
void append_spooled(std::vector<std::uint8_t>& out, const Message& message);

/// What was found in a file of the spool.
struct SpoolFileEnd {
  int journal_segment = 0;
  std::int64_t intact_bytes = 0;
  std::int64_t lost_bytes = 0;  ///< behind them: torn or damaged
};

/// Reads one frame after the other, from the first to the one that is torn or damaged, and never looks for
/// frames within others: messages can hold what looks like one. `take` is given each message, and its bytes
/// in the file, receipt included. Throws std::runtime_error naming the file where it cannot be read.
SpoolFileEnd read_spool_file(
    const std::string& path,
    const std::function<void(Message&& message, std::span<const std::uint8_t> bytes)>& take);

/// The segment of the journal that a file's header names; 0 where it has none that can be read.
int spool_journal_segment(const std::string& path);

/// The first segment of the journal that may hold messages of the spool in a directory; nothing where there
/// are no files. Segments from there on are needed to know which messages of the spool were handled.
std::optional<int> first_segment_of_spool(const std::string& directory);

}  // namespace isthmus
