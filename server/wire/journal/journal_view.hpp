#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/wire/journal/frames/segment_header.hpp"
#include "server/wire/journal/set_aside.hpp"

namespace isthmus {

struct JournalSegment {
  int number = 0;
  std::string path;
  std::optional<SegmentHeader> header;  ///< none in a journal without checks
};

/// What a journal's directory holds, once it is known that its segments belong together: each has the header
/// of its number, of the same journal, and of the segment before it.
struct JournalView {
  std::string directory;
  std::vector<JournalSegment> segments;  ///< in order, without a gap; the first ones may have been pruned
  std::map<int, std::string> snapshots;  ///< snapshot-000001.isthmus, ...: the state after that segment
  std::string unbegun;  ///< the last segment, where a crash left it without a header; or empty
  /// False: it was written before journals had headers and entries, and nothing of it can be checked.
  bool verified = true;
  SetAsideEvents set_aside;  ///< of its events
  std::vector<std::string> warnings;
};

/// Throws std::runtime_error naming the directory or the file, and the reason: it cannot be read, or its
/// segments do not belong together, or one is missing between others or before a snapshot of this journal.
/// Nothing is modified.
JournalView view_journal(const std::string& directory);

/// Throws std::runtime_error naming the first segment where it is missing and no intact snapshot of this
/// journal covers it.
void require_beginning(const JournalView& journal);

/// The snapshots that are whole and this journal's, by the number of the segment they end with; the
/// trajectory's rows are not looked at. `warn` is called for the others.
std::map<int, std::string> own_snapshots(const JournalView& journal,
                                         const std::function<void(const std::string&)>& warn = {});

/// Why a snapshot with this number is not this journal's; empty: it is.
std::string why_foreign(const JournalPlace& place, const JournalView& journal, int number);

}  // namespace isthmus
