#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "server/engine/input/options/map_options.hpp"
#include "server/engine/input/options/place_options.hpp"
#include "server/engine/map/map.hpp"
#include "server/engine/map/weak_link.hpp"

namespace isthmus {

/// A fit of a whole island on a copy of the map, in a thread of its own: begun at one event, and applied at a
/// later one that a rule decides (after as many events as the island has patches, or 20 ms a patch, so that
/// it is hardly ever late). A caller who asks earlier waits.
class FitJob {
 public:
  struct Result {
    std::vector<PatchId> patches;  ///< of the island
    std::vector<Pose> poses;       ///< by patch id, of all patches that the map had
    bool ok = false;
    /// Of a loop: of its second end relative to the first, before it was closed.
    std::optional<Eigen::Matrix3d> covariance;
    std::vector<ClosureId> rests_on;  ///< by which the map knew that, by id
    /// Of a loop: relations that were wrong if it is right. The poses are those without them.
    std::vector<RelationId> blamed;
    ClosureId blamed_closure;    ///< that they rest on, where it is what was wrong
    double blamed_log_odds = 0;  ///< that nothing of the kind is wrong, but for the loop

    auto members() {
      return std::tie(patches, poses, ok, covariance, rests_on, blamed, blamed_closure, blamed_log_odds);
    }
  };
  /// Asked of a loop that closes: how well one end was determined relative to the other before, and what is
  /// to blame where that is at odds with it.
  struct LoopQuestion {
    RelationGraph before;  ///< at the same poses
    PatchId a;
    PatchId b;
    OpenLoop loop;
    Reach reach;
    WeakLinkOptions weak_links;
    PlaceCandidateOptions drift;  ///< how far the map may have drifted on the way between them
    /// The loop may be taken for one that is open because something slipped: nothing is to blame then that is
    /// surer than that.
    bool may_have_slipped = false;
  };

  FitJob() = default;  ///< to be read from a snapshot
  FitJob(const Map& map, IslandId island, std::int64_t now_utime, std::optional<LoopQuestion> question,
         const MapFitOptions& options);

  /// Tells the job that an event was handled. Returns whether its result is due.
  bool advance(std::int64_t now_utime);
  IslandId island() const { return island_; }
  /// Whether the thread has ended. It does not influence the map: it only tells whether destroying the job
  /// would wait.
  bool ended() const { return result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }
  /// Waits for the result where it is late.
  Result take() { return result_.get(); }

  auto members() { return std::tie(island_, events_left_, due_utime_, result_); }

 private:
  IslandId island_;
  std::int64_t events_left_ = 0;
  std::int64_t due_utime_ = 0;
  std::shared_future<Result> result_;
};

/// Abandoned fits, kept until their threads end, since destroying one earlier would wait for its thread.
/// They do not influence the map, and are not in snapshots.
class AbandonedFits {
 public:
  void add(std::unique_ptr<FitJob> job);
  /// Destroys those whose threads have ended.
  void let_go();

 private:
  std::deque<std::unique_ptr<FitJob>> jobs_;
};

}  // namespace isthmus
