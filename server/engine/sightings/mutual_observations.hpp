#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "server/engine/robot/world.hpp"
#include "server/engine/sightings/evidence.hpp"
#include "server/engine/sightings/map_judge.hpp"
#include "server/engine/sightings/sighting_log.hpp"

namespace isthmus {

/// The patches of fixed tags, by barcode.
using TagPatches = std::map<std::int32_t, PatchId>;

/// All that robots have seen of one another and of fixed tags (Howard et al. 2006, IV-C): each sighting is
/// placed on the manifold and judged by the map. What the map cannot judge is gathered in a pool, until
/// several agree. The log knows what became of each.
class MutualObservations {
 public:
  /// One that makes sense on its own. `is_tag`: the barcode is a fixed tag's.
  void take(const SightingEvent& sighting, const std::string& target, bool is_tag, std::int64_t now_utime);
  /// A sighting that does not; kept for the record.
  void refuse(const SightingEvent& sighting, Reason reason);

  /// Places those whose time has come, and judges them by the map.
  void place(World world, const TagPatches& tags);
  /// The map has changed: it may judge those in the pool otherwise now.
  void consider_again(const TagPatches& tags);
  /// Judges a few of these.
  void judge_again(World world);
  bool is_judging_again() const { return judging_again_; }
  /// Fits the map around one of the sightings that it took in.
  void refit_next(World world);

  /// Sightings that wait for others that agree, in order of arrival.
  const std::vector<Evidence>& pool() const { return pool_; }
  /// Whether the pool has changed, or was marked as changed, since the last call.
  bool take_changed() { return std::exchange(pool_changed_, false); }
  void note_changed() { pool_changed_ = true; }
  bool has_changed() const { return pool_changed_; }

  /// Takes these out of the pool, by their places in it.
  std::vector<Evidence> take_out(const std::set<std::size_t>& places);
  /// Into the pool, with a doubt; their sightings wait. `closure`: what they spoke for, if that still counts.
  void put_back(std::vector<Evidence> evidence, Reason doubt, ClosureId closure = {});
  /// A sighting of the log, placed as it would be now; nothing where it is not known any more from where it
  /// was made.
  std::optional<Evidence> placed_again(const World& world, const TagPatches& tags, std::size_t record) const;
  /// Sightings that the map had taken in are in the pool again, where they can still be placed.
  void reopen(const World& world, const TagPatches& tags, std::span<const std::size_t> records);
  /// What was refused for what the map said: the newest, so many at most.
  std::vector<std::size_t> refused_by_map(std::size_t max_count) const;
  void doubt(std::size_t place, Reason reason) { pool_[place].doubt = reason; }
  /// Out of the pool, for what they doubt.
  void refuse(const std::set<std::size_t>& places);
  /// Removes those that are in the pool: their verdict is given elsewhere.
  void remove(std::span<const Evidence> evidence);
  void refuse_pool();
  /// Nothing that a robot saw, or that saw it, waits any longer.
  void forget_robot(const std::string& robot);

  void set_verdict(std::span<const Evidence> evidence, Verdict verdict, Reason reason,
                   ClosureId closure = {});
  /// Changes the places of those in the pool.
  void correct(const std::function<void(Evidence&)>& change) { std::ranges::for_each(pool_, change); }
  /// Islands have parted: a patch without relations needs no fit.
  void forget_lone_refits(const RelationGraph& graph);

  const SightingLog& log() const { return log_; }
  bool has_work() const { return !unplaced_.empty() || judging_again_ || !to_refit_.empty(); }

  auto members() {
    return std::tie(log_, unplaced_, pool_, pool_changed_, judging_again_, judge_, to_refit_);
  }

 private:
  void set_verdict(const Evidence& evidence, Verdict verdict, Reason reason, ClosureId closure = {});
  bool is_settled_by_map(World world, Evidence& evidence);
  void add_to_map(World world, const Evidence& evidence);
  void sort_pool();

  SightingLog log_;
  std::deque<Evidence> unplaced_;
  std::vector<Evidence> pool_;
  bool pool_changed_ = false;
  bool judging_again_ = false;  ///< some of the pool are still to be
  MapJudge judge_;
  std::deque<PatchId> to_refit_;  ///< patches that sightings were added to
};

}  // namespace isthmus
