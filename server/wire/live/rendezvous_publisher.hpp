#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "isthmus/rendezvous_t.hpp"
#include "server/engine/record/map_copy.hpp"

namespace isthmus {

rendezvous_t rendezvous_message(const MapCopy& map, const MeetingRecord& meeting, std::int64_t utime);

/// Decides when ISTHMUS_RENDEZVOUS is sent: where the meeting changed, and now and then for those who came
/// late.
class RendezvousPublisher {
 public:
  static constexpr std::chrono::seconds interval{3};

  /// The message to send now, if any.
  std::optional<rendezvous_t> due(const MapCopy& map, std::int64_t utime,
                                  std::chrono::steady_clock::time_point now);

 private:
  std::optional<MeetingRecord> sent_;
  std::chrono::steady_clock::time_point sent_at_;
};

}  // namespace isthmus
