#include "server/wire/journal/journal_view.hpp"

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "server/wire/journal/journal_files.hpp"
#include "server/wire/journal/log_file.hpp"
#include "server/wire/journal/snapshot.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_journal(const std::string& path, const std::string& reason) {
  throw std::runtime_error(path + ": " + reason);
}

std::string name_of(const std::string& path) { return fs::path(path).filename().string(); }

/// Whether a file is a log such as journals were made of before they had headers.
bool is_unchecked_log(const std::string& path) {
  LogFile file(path);
  if (!file.begins_as_log()) return false;
  for (int event = 0; event < 2; ++event) {
    const std::optional<Message> message = file.next();
    if (message && message->channel == journal_channel) return false;
  }
  return true;
}

/// A file without header that is the last one may be a segment whose first write was cut off, or not begun.
bool is_unbegun(FileBytes& file) { return can_begin_header(file.at(0, header_copy_bytes)); }

void check_numbers(const std::map<int, std::string>& segments) {
  int expected = segments.empty() ? 0 : segments.begin()->first;
  for (const auto& [number, path] : segments) {
    if (number != expected)
      refuse_journal(segment_path(fs::path(path).parent_path().string(), expected),
                     "is missing, but " + name_of(path) + " follows it");
    ++expected;
  }
}

void check_link(const JournalSegment& segment, const JournalSegment* before) {
  const SegmentHeader& header = *segment.header;
  if (header.segment != segment.number)
    refuse_journal(segment.path, "is segment " + std::to_string(header.segment) + " of a journal, not " +
                                     std::to_string(segment.number) + " as its name says");
  if (before == nullptr) return;
  if (header.journal != before->header->journal)
    refuse_journal(segment.path, "is of another journal than " + name_of(before->path));
  if (header.previous != before->header->check)
    refuse_journal(segment.path, "follows another copy of " + name_of(before->path) + " than this one");
}

void read_headers(JournalView& view) {
  for (auto segment = view.segments.begin(); segment != view.segments.end(); ++segment) {
    FileBytes file(segment->path);
    segment->header = read_segment_header(file);
    const bool is_last = segment + 1 == view.segments.end();
    if (!segment->header && is_last && is_unbegun(file)) {
      view.unbegun = segment->path;
      view.segments.pop_back();
      return;
    }
  }
}

void check_segments(JournalView& view) {
  const auto has_header = [](const JournalSegment& segment) { return segment.header.has_value(); };
  const auto is_unchecked = [](const JournalSegment& segment) { return is_unchecked_log(segment.path); };
  if (!view.segments.empty() && std::none_of(view.segments.begin(), view.segments.end(), has_header) &&
      std::all_of(view.segments.begin(), view.segments.end(), is_unchecked)) {
    view.verified = false;
    view.warnings.push_back(view.directory +
                            ": was written before journals had checks: what it holds cannot be verified");
    return;
  }
  const JournalSegment* before = nullptr;
  for (const JournalSegment& segment : view.segments) {
    if (!segment.header)
      refuse_journal(segment.path, fs::file_size(segment.path) == 0
                                       ? "is empty, but segments follow it"
                                       : "is no segment of a journal: it has no header of one");
    check_link(segment, before);
    before = &segment;
  }
}

/// Of the snapshot with this number: why it is of no use; empty: it is.
std::string why_useless(const JournalView& view, int number, const std::string& path) {
  try {
    const std::string reason = why_foreign(read_snapshot_place(path), view, number);
    return reason.empty() ? "" : path + ": " + reason;
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

/// A snapshot of this journal tells of segments that there were.
void check_end(const JournalView& view) {
  const int last = view.segments.empty() ? 0 : view.segments.back().number;
  for (auto snapshot = view.snapshots.upper_bound(last); snapshot != view.snapshots.end(); ++snapshot) {
    const auto& [number, path] = *snapshot;
    if (why_useless(view, number, path).empty())
      refuse_journal(segment_path(view.directory, number),
                     "is missing, but " + name_of(path) + " was made of it");
  }
}

}  // namespace

JournalView view_journal(const std::string& directory) {
  const JournalFiles files = list_journal(directory);
  check_numbers(files.segments);
  JournalView view;
  view.directory = directory;
  view.snapshots = files.snapshots;
  view.set_aside = read_set_aside(directory);
  for (const auto& [number, path] : files.segments) view.segments.push_back({number, path, std::nullopt});
  read_headers(view);
  check_segments(view);
  check_end(view);
  if (!view.unbegun.empty() && view.verified)
    view.warnings.push_back(view.unbegun +
                            ": is empty, as a server leaves it that ends before it has events");
  return view;
}

void require_beginning(const JournalView& journal) {
  if (journal.segments.empty() || journal.segments.front().number == 1) return;
  const int first = journal.segments.front().number;
  for (auto snapshot = journal.snapshots.lower_bound(first - 1); snapshot != journal.snapshots.end();
       ++snapshot) {
    if (why_useless(journal, snapshot->first, snapshot->second).empty()) return;
  }
  refuse_journal(segment_path(journal.directory, first - 1),
                 "is gone, and no snapshot stands for it and those before it");
}

std::map<int, std::string> own_snapshots(const JournalView& journal,
                                         const std::function<void(const std::string&)>& warn) {
  std::map<int, std::string> own;
  for (const auto& [number, path] : journal.snapshots) {
    const std::string reason = why_useless(journal, number, path);
    if (reason.empty()) own.emplace(number, path);
    if (!reason.empty() && warn) warn(reason);
  }
  return own;
}

std::string why_foreign(const JournalPlace& place, const JournalView& journal, int number) {
  if (place.segment != number) return "was made of segment " + std::to_string(place.segment);
  for (const JournalSegment& segment : journal.segments) {
    if (!segment.header) return "is of another journal";
    if (segment.header->journal != place.journal) return "is of another journal";
    const bool same = (segment.number != number || segment.header->check == place.header) &&
                      (segment.number != number + 1 || segment.header->previous == place.header);
    if (!same) return "is of another copy of this journal";
  }
  return "";
}

}  // namespace isthmus
