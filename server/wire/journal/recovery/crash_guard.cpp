#include "server/wire/journal/recovery/crash_guard.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <stdexcept>

#include "server/engine/estimator.hpp"
#include "server/wire/file/file_bytes.hpp"

namespace isthmus {
namespace {

/// An event and how often processes ended inside it, in one word, so that it changes in one store; 0: none.
/// More ends than two say nothing new.
constexpr std::uint64_t max_ends = 3;
constexpr std::uint64_t word_of(std::int64_t sequence, std::uint64_t ends) {
  return ((static_cast<std::uint64_t>(sequence) + 1) << 2) | (ends < max_ends ? ends : max_ends);
}
constexpr std::int64_t sequence_in(std::uint64_t word) { return static_cast<std::int64_t>(word >> 2) - 1; }
constexpr std::uint64_t ends_in(std::uint64_t word) { return word & max_ends; }

}  // namespace

/// The content of the file.
struct CrashGuard::Mark {
  std::atomic<std::uint64_t> inside;   ///< the event that is being taken, with the ends that were known
  std::atomic<std::uint64_t> suspect;  ///< the one inside which the process before ended
};
static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

CrashGuard::CrashGuard(const std::string& directory) {
  const std::string path = (std::filesystem::path(directory) / "crash-guard").string();
  const auto fail = [&] { throw std::runtime_error(path + ": " + errno_text(errno)); };
  const FileHandle file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  if (!file.is_open()) fail();
  std::array<std::uint8_t, sizeof(Mark)> bytes{};
  const ssize_t size = ::pread(file.get(), bytes.data(), bytes.size(), 0);
  if (size < 0) fail();
  // Written in full, so that a store needs no room on the disk.
  if (::pwrite(file.get(), bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) fail();
  void* mapped = ::mmap(nullptr, sizeof(Mark), PROT_READ | PROT_WRITE, MAP_SHARED, file.get(), 0);
  if (mapped == MAP_FAILED) fail();
  mark_ = static_cast<Mark*>(mapped);
  const std::uint64_t inside = mark_->inside;
  if (inside == 0) return;
  // In this order a kill in between is not counted: the next start finds the same once more.
  mark_->suspect = word_of(sequence_in(inside), ends_in(inside) + 1);
  mark_->inside = 0;
}

CrashGuard::~CrashGuard() { ::munmap(mark_, sizeof(Mark)); }

std::int64_t CrashGuard::suspect() const { return sequence_in(mark_->suspect); }
int CrashGuard::ends() const { return static_cast<int>(ends_in(mark_->suspect)); }

void CrashGuard::enter(std::int64_t sequence) {
  mark_->inside = word_of(sequence, sequence == suspect() ? ends_in(mark_->suspect) : 0);
}

void CrashGuard::leave() {
  const std::uint64_t inside = mark_->inside;
  mark_->inside = 0;
  if (inside != 0 && sequence_in(inside) == suspect()) mark_->suspect = 0;
}

void CrashGuard::acquit() { mark_->suspect = 0; }

Outcome handle_guarded(CrashGuard* guard, std::int64_t sequence, Estimator& estimator, const Event& event,
                       const std::function<void(const Event&)>& before) {
  const bool guarded =
      guard != nullptr && sequence >= 0 && !std::holds_alternative<ConfigurationEvent>(event.body);
  if (guarded) guard->enter(sequence);
  if (before) before(event);
  Outcome outcome = estimator.handle(event);
  if (guarded) guard->leave();
  return outcome;
}

}  // namespace isthmus
