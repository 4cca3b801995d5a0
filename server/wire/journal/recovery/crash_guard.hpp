#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>

namespace isthmus {

class Estimator;
struct Event;
struct Outcome;

/// Tells after a crash which event of the journal the engine was taking. While the engine takes an event, its
/// number stands in a small file that is mapped into memory: noting it is a store, and the kernel keeps it
/// when the process ends, however it does.
///
/// An event inside which the process ended twice, and that it never got past in between, is condemned: it
/// would bring the engine down each time. A process that is killed from outside is counted too, where it was
/// inside an event: to be condemned wrongly, an event must have been hit twice running.
class CrashGuard {
 public:
  /// Reads what the process before left in the directory's crash-guard. Throws std::runtime_error naming the
  /// file and the reason where it cannot be read or written. The directory must be held by this process
  /// (JournalDirectory).
  explicit CrashGuard(const std::string& directory);
  ~CrashGuard();
  CrashGuard(const CrashGuard&) = delete;
  CrashGuard& operator=(const CrashGuard&) = delete;

  /// The event inside which processes before ended, one after the other; −1: none.
  std::int64_t suspect() const;
  /// How often.
  int ends() const;
  bool is_condemned(std::int64_t sequence) const { return ends() >= 2 && sequence == suspect(); }

  /// The engine begins to take an event; `leave` must follow where it comes back, and must not where it
  /// throws.
  void enter(std::int64_t sequence);
  /// The engine has taken it.
  void leave();
  /// The suspect was set aside.
  void acquit();

 private:
  struct Mark;

  Mark* mark_ = nullptr;
};

/// The engine takes an event of a journal. Without a guard, or for an event that has no number there or is
/// the configuration, nothing is noted. `before`: for tests, which let the engine fail.
Outcome handle_guarded(CrashGuard* guard, std::int64_t sequence, Estimator& estimator, const Event& event,
                       const std::function<void(const Event&)>& before = {});

}  // namespace isthmus
