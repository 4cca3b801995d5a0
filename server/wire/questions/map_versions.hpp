#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// Tells versions of the map, and what changed since one of them. A version is the event time, in
/// microseconds, of the first copy that looked as the map does now: it grows, also over a restart.
class MapVersions {
 public:
  /// `utime`: of the copy. Returns whether it differs from the one before: patches that are new, moved or
  /// left out, or relations that came or went.
  bool note(const MapCopy& map, std::int64_t utime);

  std::int64_t version() const { return version_; }

  /// Patches that are new, have moved or were left out after a version, by id: all of them for one that was
  /// before all that were noted. Nothing for a version that is to come.
  std::optional<std::vector<PatchId>> changed_since(std::int64_t version) const;

 private:
  std::int64_t version_ = 0;
  std::vector<std::int64_t> changed_;  // by patch: the version that it changed to
  std::vector<Pose> poses_;
  std::vector<PatchId> left_out_;
  std::size_t relations_ = 0;
  RelationId last_relation_;
};

}  // namespace isthmus
