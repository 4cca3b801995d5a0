#pragma once

#include <cstdint>
#include <deque>
#include <set>
#include <string>
#include <vector>

#include "server/wire/intake/inbox.hpp"
#include "server/wire/intake/spool.hpp"
#include "server/wire/journal/journal.hpp"

namespace isthmus {

/// The numbers of the received messages that a journal holds from its segment `first` on, or tells that they
/// were dropped.
std::set<std::int64_t> settled_messages(const std::vector<JournalSegment>& segments, int first);

/// Follows each received message to its end: it leaves the spool once the disk has it in the journal, as an
/// event or among those that were dropped. One thread.
class Settlement {
 public:
  Settlement(Journal& journal, Spool& spool) : journal_(journal), spool_(spool) {}

  /// The journal has just taken this message.
  void journalled(const Message& message);
  /// Messages of a robot were not taken.
  void dropped(const std::string& robot, DropReason reason, const Dropped& dropped);

  /// Appends those dropped so far to the journal, in one record.
  void record_drops(std::int64_t utime);
  /// Messages whose record is on the disk leave the spool.
  void settle();

 private:
  struct Recorded {
    std::int64_t appended = 0;  ///< the journal's events up to and with the one that tells of it
    std::int64_t received = 0;
  };

  Journal& journal_;
  Spool& spool_;
  Drops drops_;                    ///< that are not in the journal
  std::deque<Recorded> recorded_;  ///< in the journal, perhaps not on the disk yet
};

}  // namespace isthmus
