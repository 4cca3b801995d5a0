#include "server/wire/intake/inbox.hpp"

#include <algorithm>
#include <utility>

#include "server/wire/intake/spool.hpp"

namespace isthmus {
namespace {

Message copy_of(std::int64_t utime, const std::string& channel, std::span<const std::uint8_t> bytes,
                const std::optional<Signature>& signature) {
  return {utime, channel, {bytes.begin(), bytes.end()}, signature};
}

}  // namespace

void Inbox::keep_in(std::shared_ptr<Spool> spool) {
  const std::lock_guard lock(mutex_);
  spool_ = std::move(spool);
}

void Inbox::push(const std::string& sender, bool is_scan, std::int64_t utime, const std::string& channel,
                 std::span<const std::uint8_t> bytes, const std::optional<Signature>& signature) {
  if (clock_) utime = clock_();
  std::unique_lock lock(mutex_);
  if (!is_welcome(queue_name(sender), bytes.size())) return;
  Message message = copy_of(utime, channel, bytes, signature);
  if (const std::shared_ptr<Spool> spool = spool_) {
    const bool known = sender.empty() || reserved_.contains(sender);
    lock.unlock();  // the engine need not wait for the disk
    spool->append(message, known);
    lock.lock();
    if (closed_) return;  // in the spool, for the next start
  }
  push_locked(queue_name(sender), is_scan, std::move(message));
}

void Inbox::put_back(const std::string& sender, bool is_scan, Message message) {
  const std::lock_guard lock(mutex_);
  push_locked(queue_name(sender), is_scan, std::move(message));
}

/// False: it will not be taken, which has been counted.
bool Inbox::is_welcome(const std::string& queue, std::size_t bytes) {
  if (closed_) return false;
  if (bytes > limits_.message_bytes) drops_[queue][DropReason::bad_length].count += 1;
  return bytes <= limits_.message_bytes;
}

void Inbox::push_locked(const std::string& queue, bool is_scan, Message message) {
  while (!has_room(queue, message.bytes.size())) {
    const std::int64_t number = remove_oldest(senders_[queue]);
    Dropped& dropped = drops_[queue][DropReason::queue_full];
    dropped.count += 1;
    if (number >= 0) dropped.received.push_back(number);
  }
  add(queue, is_scan, std::move(message));
}

bool Inbox::push_waiting(const std::string& sender, bool is_scan, std::int64_t utime,
                         const std::string& channel, std::span<const std::uint8_t> bytes,
                         const std::optional<Signature>& signature) {
  std::unique_lock lock(mutex_);
  const std::string& queue = queue_name(sender);
  if (!is_welcome(queue, bytes.size())) return !closed_;
  changed_.wait(lock, [&] { return closed_ || has_room(queue, bytes.size()); });
  if (closed_) return false;
  add(queue, is_scan, copy_of(utime, channel, bytes, signature));
  return true;
}

void Inbox::reserve(const std::string& sender) {
  const std::lock_guard lock(mutex_);
  reserved_.insert(sender);
}

void Inbox::introduce(const std::string& robot) {
  const std::lock_guard lock(mutex_);
  if (reserved_.size() < limits_.robots) reserved_.insert(robot);
}

bool Inbox::is_reserved(const std::string& sender) const {
  const std::lock_guard lock(mutex_);
  return reserved_.contains(sender);
}

void Inbox::refuse_strangers() {
  const std::lock_guard lock(mutex_);
  refuses_strangers_ = true;
}

bool Inbox::is_stranger(const std::string& robot) const {
  const std::lock_guard lock(mutex_);
  return refuses_strangers_ && !reserved_.contains(robot);
}

void Inbox::count_drop(const std::string& sender, DropReason reason) {
  const std::lock_guard lock(mutex_);
  // Anybody can make up names: not more of them than queues between one take_drops and the next.
  const bool named = drops_.contains(sender) || drops_.size() < limits_.senders + reserved_.size();
  drops_[named ? queue_name(sender) : "(others)"][reason].count += 1;
}

void Inbox::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

bool Inbox::finished() const {
  const std::lock_guard lock(mutex_);
  return closed_ && entries_.empty();
}

std::optional<Message> Inbox::pop(std::chrono::milliseconds wait) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, wait, [&] { return closed_ || !entries_.empty(); });
  if (entries_.empty()) return std::nullopt;
  auto node = entries_.extract(next_key());
  Entry& entry = node.mapped();
  Sender& sender = senders_[entry.sender];
  (entry.is_scan ? sender.scans : sender.others).pop_front();
  sender.bytes -= entry.message.bytes.size();
  all_bytes_ -= entry.message.bytes.size();
  changed_.notify_all();
  return std::move(entry.message);
}

Drops Inbox::take_drops() {
  const std::lock_guard lock(mutex_);
  return std::exchange(drops_, {});
}

std::size_t Inbox::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

const std::string& Inbox::queue_name(const std::string& sender) {
  static const std::string shared = "(others)";
  if (senders_.contains(sender) || reserved_.contains(sender)) return sender;
  // Anybody can make up names: only those with something waiting hold a place.
  const std::size_t most = limits_.senders + reserved_.size();
  if (senders_.size() >= most)
    std::erase_if(senders_, [](const auto& entry) { return entry.second.empty(); });
  return senders_.size() < most ? sender : shared;
}

/// Of the next sender in turn that has something; of the oldest message otherwise. There must be one.
std::uint64_t Inbox::next_key() {
  if (order_ == InboxOrder::arrival) return entries_.begin()->first;
  const auto has_some = [](const auto& entry) { return !entry.second.empty(); };
  auto next = std::find_if(senders_.upper_bound(last_served_), senders_.end(), has_some);
  if (next == senders_.end()) next = std::find_if(senders_.begin(), senders_.end(), has_some);
  last_served_ = next->first;
  return next->second.oldest();
}

std::uint64_t Inbox::Sender::oldest() const {
  if (scans.empty()) return others.front();
  return others.empty() ? scans.front() : std::min(scans.front(), others.front());
}

bool Inbox::has_room(const std::string& sender, std::size_t bytes) const {
  const auto found = senders_.find(sender);
  if (found == senders_.end()) return true;
  const Sender& queue = found->second;
  const std::size_t messages = queue.scans.size() + queue.others.size();
  return messages == 0 || (messages < limits_.messages && queue.bytes + bytes <= limits_.bytes &&
                           all_bytes_ + bytes <= limits_.all_bytes);
}

void Inbox::add(const std::string& sender, bool is_scan, Message message) {
  Sender& queue = senders_[sender];
  queue.bytes += message.bytes.size();
  all_bytes_ += message.bytes.size();
  (is_scan ? queue.scans : queue.others).push_back(next_key_);
  entries_.emplace_hint(entries_.end(), next_key_, Entry{std::move(message), sender, is_scan});
  next_key_ += 1;
  changed_.notify_all();
}

/// Its number in the spool; −1: it is not there.
std::int64_t Inbox::remove_oldest(Sender& sender) {
  std::deque<std::uint64_t>& keys = sender.scans.empty() ? sender.others : sender.scans;
  const auto entry = entries_.find(keys.front());
  keys.pop_front();
  sender.bytes -= entry->second.message.bytes.size();
  all_bytes_ -= entry->second.message.bytes.size();
  const std::int64_t number = entry->second.message.received;
  entries_.erase(entry);
  return number;
}

}  // namespace isthmus
