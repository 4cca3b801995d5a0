#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "server/wire/intake/event_clock.hpp"
#include "server/wire/message/drops.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {

/// Bounds of what may wait between the receiving thread and the engine. A robot back from a radio shadow
/// sends minutes at once: at 40 scans and 40 odometries a second, 50,000 messages are ten minutes.
struct InboxLimits {
  std::size_t messages = 50'000;              ///< of each sender
  std::size_t bytes = 64 * 1024 * 1024;       ///< of each sender
  std::size_t all_bytes = 512 * 1024 * 1024;  ///< of all senders together
  std::size_t message_bytes = 1024 * 1024;    ///< a longer message is none of ours
  std::size_t senders = 64;  ///< with something waiting, unreserved; those beyond share a queue
  std::size_t robots = 256;  ///< that may introduce themselves; as AdmissionLimits
};

/// Which message is next: senders in turn, so that one robot's flood or backlog does not delay another's
/// poses; or the oldest, as a log has them.
enum class InboxOrder { fair, arrival };

class Spool;

/// Messages of each sender in order of arrival, bounded for each, so that one robot's flood does not cost
/// another's messages. Where a sender's queue is full its oldest scan goes first: the next one says nearly
/// the same.
class Inbox {
 public:
  /// `clock`: gives each message its time as it is pushed; without it they come with one.
  explicit Inbox(InboxLimits limits = {}, InboxOrder order = InboxOrder::fair, ClockReading clock = {})
      : limits_(limits), order_(order), clock_(std::move(clock)) {}

  /// From now on `push` writes each message to the spool before it waits here; none: no longer. Any thread.
  void keep_in(std::shared_ptr<Spool> spool);

  /// What a spool had kept: in front of all that comes after. Not beyond the limits.
  void put_back(const std::string& sender, bool is_scan, Message message);

  /// Copies the message. Any thread.
  void push(const std::string& sender, bool is_scan, std::int64_t utime, const std::string& channel,
            std::span<const std::uint8_t> bytes, const std::optional<Signature>& signature = std::nullopt);

  /// The same, but waits while the queue is full instead of dropping; false once closed. For sources that can
  /// wait and have times of their own, such as a log file.
  bool push_waiting(const std::string& sender, bool is_scan, std::int64_t utime, const std::string& channel,
                    std::span<const std::uint8_t> bytes,
                    const std::optional<Signature>& signature = std::nullopt);

  /// Reserves a queue for this sender, whatever names others make up. For as many senders as a map may
  /// have. Any thread.
  void reserve(const std::string& sender);

  /// The same for a robot that introduces itself, as far as there is room for more.
  void introduce(const std::string& robot);
  bool is_reserved(const std::string& sender) const;

  /// From now on all robots on the map are reserved: others are strangers. Any thread.
  void refuse_strangers();
  bool is_stranger(const std::string& robot) const;

  /// Counts a message that was refused before it came here.
  void count_drop(const std::string& sender, DropReason reason);

  /// Nothing more will come: push drops silently from now on.
  void close();
  /// Closed and empty.
  bool finished() const;

  /// The next message; nothing after `wait`, or at once when closed and empty.
  std::optional<Message> pop(std::chrono::milliseconds wait);

  /// Messages dropped since the last call, by sender and reason.
  Drops take_drops();

  std::size_t size() const;

 private:
  struct Entry {
    Message message;
    std::string sender;
    bool is_scan = false;
  };
  struct Sender {
    std::deque<std::uint64_t> scans;  ///< keys of entries_, rising
    std::deque<std::uint64_t> others;
    std::size_t bytes = 0;

    bool empty() const { return scans.empty() && others.empty(); }
    std::uint64_t oldest() const;
  };

  const std::string& queue_name(const std::string& sender);
  std::uint64_t next_key();
  bool has_room(const std::string& sender, std::size_t bytes) const;
  void add(const std::string& sender, bool is_scan, Message message);
  std::int64_t remove_oldest(Sender& sender);
  void push_locked(const std::string& queue, bool is_scan, Message message);
  bool is_welcome(const std::string& queue, std::size_t bytes);

  InboxLimits limits_;
  InboxOrder order_;
  ClockReading clock_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool closed_ = false;
  bool refuses_strangers_ = false;
  std::uint64_t next_key_ = 0;
  std::size_t all_bytes_ = 0;
  std::map<std::uint64_t, Entry> entries_;  ///< by arrival
  std::map<std::string, Sender> senders_;
  std::set<std::string> reserved_;
  std::string last_served_;
  Drops drops_;
  std::shared_ptr<Spool> spool_;
};

}  // namespace isthmus
