#pragma once

#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "server/engine/closures/closures.hpp"
#include "server/engine/hypotheses/find_record.hpp"
#include "server/engine/hypotheses/hypothesis_counts.hpp"
#include "server/engine/hypotheses/hypothesis_pool.hpp"
#include "server/engine/map/credit.hpp"
#include "server/engine/places/answers_along_way.hpp"
#include "server/engine/places/look_up_tables.hpp"
#include "server/engine/places/place_memory.hpp"
#include "server/engine/places/place_searcher.hpp"
#include "server/engine/places/places_job.hpp"
#include "server/engine/places/recent_way.hpp"

namespace isthmus {

/// Where on the map the last metres of a robot's way may be, on the way to an answer.
struct PlaceQuery {
  std::vector<PatchId> newest_first;
  std::string robot;
  double at_m = 0;                  ///< along its way; 0: asked late, when the robot had gone on
  std::vector<std::string> not_of;  ///< by name: robots whose patches it was searched for among before
  PlaceSearcher search;

  bool is_late() const { return at_m <= 0; }

  auto members() { return std::tie(newest_first, robot, at_m, not_of, search); }
};

/// Loops and merges that scans alone suggest, closed lazily: every few metres of a robot's way, what it saw
/// last is searched for at the places where it may have been before, on its own island within the relative
/// covariance and on others anywhere. What is found there, once and only once, waits until several finds
/// agree all around the loops that they form; those are proposed to the closures, which try them out beside
/// the map. Where to search is looked up beside the engine (places_job.hpp), and searching is done in bounded
/// steps on credit that grows with time, so no event waits long for it. Where more is asked than that is
/// enough for, the newest come first, and the others once none waits, on their own island and some others.
class Hypotheses {
 public:
  void advance(World world, Closures& closures);
  /// Islands have merged one after the other, of which these patches were the smaller each time: wherever its
  /// robots drove, they may have driven on what the other has mapped. Their ways are searched for among the
  /// others' patches, when nothing newer waits, but for those that are matched with others' by then; a patch
  /// that was on several of them is asked of once.
  void ask_again(const Map& map, std::span<const std::vector<PatchId>> sides,
                 const HypothesisOptions& options);

  /// All that is left, as if nothing more will come, and with nothing on trial: first this, which asks of the
  /// way since a robot was last asked of too, then searches until there are no more,
  void begin_finish(World world, Closures& closures);
  bool finish_search(World world);
  /// then, as the maps are as large now as they will be and what was undecided may be plain, all that was
  /// tried once more: what is put on trial by one call is to be decided before the next. False: nothing was.
  void try_all_again() { pool_.try_all_again(); }
  bool propose_last(World world, Closures& closures);
  bool has_work() const { return !queue_.empty() || !late_.empty() || looking_up_ || can_step(); }

  /// A robot's data is taken out.
  void forget_robot(const Map& map, const std::string& robot);

  std::vector<UndecidedHypothesis> undecided() const { return pool_.undecided(); }
  /// Something else has shown it to be false.
  void refute(ClosureId id, Reason reason) { pool_.refute(id, reason); }

  const HypothesisCounts& counts() const { return counts_; }
  /// The newest finds, as they were when they were made; patches of a robot whose data was taken out may be
  /// among them.
  const std::deque<FindRecord>& found() const { return found_; }

  auto members() {
    return std::tie(ways_, newest_, queue_, late_, asked_, looking_up_, ready_, query_, pool_, counts_,
                    found_, credit_, patches_, places_, tables_);
  }

 private:
  /// A robot's way on its newest patches.
  struct Way {
    RecentWay recent;
    double since_query_m = 0;
    double length_m = 0;
    AnswersAlongWay answers;

    auto members() { return std::tie(recent, since_query_m, length_m, answers); }
  };

  void follow(World world);
  void note_patch(World world, const std::string& robot, PatchId patch);
  /// Has a robot's last metres searched for, where they are enough.
  void ask(const std::string& robot, Way& way, const HypothesisOptions& options);
  /// Some of those that waited until there are no others, but not what is known meanwhile.
  void next_late(World world);
  void look_up(World world);
  void end_look_up();
  void work(World world);
  bool can_step() const { return query_ || !ready_.empty(); }
  /// One bounded piece of the search; what it costs, in nominal microseconds.
  std::int64_t step(World world);
  std::int64_t begin(World world, PlaceQuery& query);
  PlaceDecision decide(World world, PlaceQuery& query);
  void take(World world, const std::string& robot, Find find);

  std::map<std::string, Way> ways_;
  std::map<std::string, PatchId> newest_;
  // A query's way: it waits, its places are looked up beside the engine, it is ready, it is searched.
  std::deque<PlaceQuery> queue_;
  std::deque<PlaceQuery> late_;    ///< of before a merge, or put off: they wait until there are no others
  std::vector<PlaceQuery> asked_;  ///< what is being looked up; no patches: not wanted any more
  std::optional<PlacesJob> looking_up_;
  std::deque<PlaceQuery> ready_;
  std::optional<PlaceQuery> query_;
  HypothesisPool pool_;
  HypothesisCounts counts_;
  std::deque<FindRecord> found_;
  Credit credit_;
  std::size_t patches_ = 0;  ///< when last worked
  PlaceMemory places_;       ///< what can be reckoned anew
  KeptTables tables_;
};

}  // namespace isthmus
