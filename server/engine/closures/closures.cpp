#include "server/engine/closures/closures.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>

#include "server/engine/closures/closure_draft.hpp"
#include "server/engine/closures/merge_account.hpp"
#include "server/engine/closures/rival_merge.hpp"
#include "server/engine/closures/taking_back.hpp"

namespace isthmus {
namespace {

std::vector<PatchId> smaller_side(const RelationGraph& graph, const Proposal& merge) {
  std::vector<PatchId> older = graph.patches_of(graph.island(merge.older));
  std::vector<PatchId> younger = graph.patches_of(graph.island(merge.younger));
  return older.size() < younger.size() ? older : younger;
}

}  // namespace

void Closures::take(const SightingEvent& sighting, const std::string& target, bool is_tag,
                    std::int64_t now_utime) {
  observations_.take(sighting, target, is_tag, now_utime);
}

void Closures::refuse(const SightingEvent& sighting, Reason reason) {
  observations_.refuse(sighting, reason);
}

void Closures::advance(World world) {
  observations_.place(world, tags_.patches());
  if (observations_.is_judging_again()) observations_.judge_again(world);
  // Nothing is proposed while some of the pool are still to be judged.
  if (!observations_.is_judging_again() && observations_.take_changed()) {
    tags_.place(world, observations_);
    const std::vector<Evidence>& pool = observations_.pool();
    const std::vector<SightingGroup> groups = groups_of(world.map, pool, world.options.closures);
    observations_.refuse(superfluous(pool, groups, world.now_utime, world.options.closures));
    propose(world);
  }
  if (trials_.work(world)) end_trial(world);
  // What is on trial began with the map as it is: merges may go only between trials.
  if (!on_trial() && !doubts_.empty() && doubts_.front().partings.is_due(world.now_utime))
    settle_doubt(world);
  observations_.refit_next(world);
}

void Closures::begin_finish(World world) {
  world.no_more_waiting = true;
  observations_.place(world, tags_.patches());
  tags_.place(world, observations_);
}

bool Closures::try_waiting(World world) {
  if (step_trial(world)) return true;
  if (!doubts_.empty()) {
    settle_doubt(world);
    return true;
  }
  if (observations_.is_judging_again()) {
    observations_.judge_again(world);
    return true;
  }
  world.no_more_waiting = true;
  observations_.take_changed();
  propose(world);
  return on_trial() || observations_.has_changed() || observations_.is_judging_again();
}

bool Closures::finish_step(World world) {
  if (try_waiting(world)) return true;
  observations_.refuse_pool();
  return false;
}

bool Closures::step_trial(World world) {
  if (!on_trial()) return false;
  if (!trials_.trial()->done()) {
    trials_.step(world);
  } else {
    end_trial(world);
  }
  return on_trial();
}

void Closures::propose(World world) {
  if (on_trial()) return;
  for (const SightingGroup& group :
       smallest_merges_first(world.map, groups_of(world.map, observations_.pool(), world.options.closures))) {
    const std::optional<GroupAgreement> agreement = proposer_.look_at(world, observations_.pool(), group);
    if (!agreement) continue;
    propose(world, group, *agreement);
    if (!on_trial()) observations_.note_changed();  // refused at once: the groups are no longer these
    return;
  }
}

void Closures::propose(World world, const SightingGroup& group, const GroupAgreement& agreement) {
  std::vector<Evidence> supporters = observations_.take_out(agreement.supporters);
  proposer_.note_trial(group.key, supporters.size());
  const ClosureDraft draft = draft_of_sightings(world.map, ledger_.take_id(), group, agreement, supporters,
                                                world.now_utime, world.options);
  Entry& closure = ledger_.enter(draft, std::move(supporters));
  if (draft.proposal.relations.empty()) {
    ledger_.decide(closure, ClosureState::refused, Reason::no_relation);
    observations_.set_verdict(closure.evidence, Verdict::refused, Reason::no_relation, closure.record.id);
    return;
  }
  observations_.set_verdict(closure.evidence, Verdict::waiting, Reason::on_trial, closure.record.id);
  begin_trial(world, draft.proposal);
}

ClosureId Closures::propose_from_scans(World world, const ScanProposal& finds) {
  const ClosureId id = finds.id.valid() ? finds.id : ledger_.take_id();
  const ClosureDraft draft = draft_of_finds(world.map, id, finds, world.now_utime, world.options);
  ledger_.enter(draft);
  begin_trial(world, draft.proposal);
  return id;
}

// What would bring two islands together as is forbidden is known to before it is tried out.
void Closures::begin_trial(World world, Proposal proposal) {
  Entry& closure = ledger_.at(proposal.id);
  const bool merge = proposal.merge;
  if (!merge) proposal.loop.closed_before = ledger_.closed_loops(world.map.graph(), proposal.older);
  trials_.begin(world, std::move(proposal));
  if (merge && refuse_as_forbidden(world, closure, trials_.trial()->map())) trials_.take();
}

void Closures::propose_start(World world, const Relation& relation, const std::string& robot,
                             const std::string& with) {
  while (step_trial(world)) {
  }
  const ClosureDraft draft =
      draft_of_start(world.map, ledger_.take_id(), relation, {robot, with}, world.now_utime);
  ledger_.enter(draft);
  trials_.begin(world, draft.proposal);
}

void Closures::end_trial(World world) {
  const std::unique_ptr<Trial> trial = trials_.take();
  Entry& closure = ledger_.at(trial->proposal().id);
  if (trial->undecided() && !closure.record.from_scans) return put_off(closure);
  closure.record.patches_touched = trial->patches_touched();
  closure.record.work_steps = trial->work_steps();
  closure.record.account = trial->account();
  closure.record.end_utime = world.now_utime;
  if (trial->undecided()) {
    ledger_.decide(closure, ClosureState::waiting, trial->refusal(), trial->patches_touched());
    return doubt_merges(world, closure);
  }
  if (!trial->accepted()) {
    ledger_.decide(closure, ClosureState::refused, trial->refusal());
    observations_.put_back(closure.evidence, trial->refusal(), closure.record.id);
    doubt_merges(world, closure);
  } else if (trial->proposal().measured || !refuse_if_forbidden(world, closure, trial->map())) {
    accept(world, *trial, closure);
  }
  observations_.consider_again(tags_.patches());
}

void Closures::accept(World world, const Trial& trial, Entry& closure) {
  if (const ClosureId wrong = trial.account().blamed_closure; wrong.valid()) {
    withdraw(world, wrong);
  } else {
    for (const RelationId id : trial.blamed())
      if (const Relation* relation = world.map.graph().find(id)) closure.blamed.push_back(*relation);
  }
  if (trial.proposal().merge) {
    merged_.push_back(smaller_side(world.map.graph(), trial.proposal()));
    doubt_anew();
  }
  trial.commit(world.map);
  changed_.push_back(trial.proposal().older);
  ledger_.decide(closure, ClosureState::accepted,
                 closure.record.from_scans ? Reason::from_scans : closure.record.reason);
  const Reason reason = trial.proposal().merge ? Reason::merged_islands : Reason::closed_loop;
  observations_.set_verdict(closure.evidence, Verdict::accepted, reason, closure.record.id);
  proposer_.forget(trial.proposal().older, trial.proposal().younger);
}

void Closures::withdraw(World world, ClosureId contradicted) {
  Entry& wrong = ledger_.at(contradicted);
  if (wrong.record.state != ClosureState::accepted) return;
  std::ranges::copy(take_back(world, contradicted, ledger_, observations_, tags_),
                    std::back_inserter(changed_));
  ledger_.decide(wrong, ClosureState::withdrawn, Reason::contradicted);
  observations_.put_back(std::exchange(wrong.evidence, {}), Reason::unsupported);
  doubt_anew();
}

void Closures::doubt_merges(World world, const Entry& closure) {
  std::optional<PartingQuestion> question = closure.record.from_scans
                                                ? doubted_by_scans(ledger_, closure, world.options.trial)
                                                : doubted_by_sightings(ledger_, closure);
  if (!question) return;
  doubts_.push_back(
      {closure.record.id, PartingsJob(world.map, *std::move(question), world.now_utime, world.options)});
}

// Their answers are of a map that is no more.
void Closures::doubt_anew() {
  for (Doubt& doubt : doubts_) doubt.is_of_another_map = true;
}

void Closures::settle_doubt(World world) {
  const Doubt doubt = std::move(doubts_.front());
  doubts_.erase(doubts_.begin());
  const Entry* closure = ledger_.find(doubt.by);
  if (closure == nullptr) return;
  if (doubt.is_of_another_map) return doubt_merges(world, *closure);
  const std::vector<Parting>& partings = doubt.partings.partings();
  closure->record.from_scans ? withdraw_what_it_rivals(world, *closure, partings)
                             : withdraw_what_it_contradicts(world, partings);
}

// Of what the map believes and what sightings say instead, one is wrong: where they are more than speak for
// the merge that parts the two, it goes, and all is looked at anew without it. It may come again by what
// speaks for it.
void Closures::withdraw_what_it_contradicts(World world, std::span<const Parting> partings) {
  const std::optional<MergeAccount> account =
      contradicted_merge(world, tags_.patches(), ledger_, observations_, partings);
  if (!account) return;
  withdraw(world, account->merge);
  observations_.reopen(world, tags_.patches(), account->agreed);
  observations_.reopen(world, tags_.patches(),
                       observations_.refused_by_map(world.options.closures.max_reopened));
  proposer_.forget();
}

// Of two ways in which scans lay two maps over one another, one is wrong.
void Closures::withdraw_what_it_rivals(World world, const Entry& closure, std::span<const Parting> partings) {
  if (const auto rivalled = rivalled_merge(ledger_, closure, partings, world.options.trial))
    withdraw(world, rivalled->merge);
}

// Neither accepted nor refused: as if it had not been proposed yet. Its sightings wait for more.
void Closures::put_off(Entry& closure) {
  if (closure.record.from_scans) return ledger_.decide(closure, ClosureState::waiting, Reason::map_changed);
  observations_.put_back(std::exchange(closure.evidence, {}), Reason::too_little_support);
  ledger_.strike(closure.record.id);
  observations_.consider_again(tags_.patches());
}

// What a trial was begun on will no longer be.
void Closures::put_off_trial() {
  const std::unique_ptr<Trial> trial = trials_.take();
  if (!trial) return;
  Entry& closure = ledger_.at(trial->proposal().id);
  if (closure.record.from_scans) return put_off(closure);
  ledger_.decide(closure, ClosureState::refused, Reason::map_changed);
  observations_.put_back(std::exchange(closure.evidence, {}), Reason::unsupported);
}

void Closures::refuse_from_scans(ClosureId id, Reason reason) {
  Entry* closure = ledger_.find(id);
  if (closure == nullptr || closure->record.state != ClosureState::waiting) return;
  if (trials_.is_on_trial(id)) trials_.take();
  closure->record.state = ClosureState::refused;
  closure->record.reason = reason;
}

DropReason Closures::forbid(World world, ClosureId id, bool must_be_accepted) {
  Entry* closure = ledger_.find(id);
  if (closure == nullptr) {
    if (must_be_accepted) return DropReason::no_such_closure;
    ledger_.forbid_id(id);
    return DropReason::none;
  }
  const bool accepted = closure->record.state == ClosureState::accepted;
  if (must_be_accepted && !accepted) return DropReason::not_accepted;
  closure->forbidden = true;
  if (trials_.is_on_trial(id))
    closure->record.joining = as_mapped(trials_.take()->map(), closure->record.joining);
  if (accepted) {
    put_off_trial();  // it was begun on a map that will no longer be
    std::ranges::copy(take_back(world, id, ledger_, observations_, tags_), std::back_inserter(changed_));
    doubt_anew();
  }
  ledger_.decide(*closure, accepted ? ClosureState::withdrawn : ClosureState::refused, Reason::forbidden);
  observations_.set_verdict(closure->evidence, Verdict::refused, Reason::forbidden, id);
  observations_.remove(closure->evidence);
  look_at_all_again();
  return DropReason::none;
}

DropReason Closures::allow(ClosureId id) {
  Entry* closure = ledger_.find(id);
  if (closure == nullptr) return ledger_.allow_id(id) ? DropReason::none : DropReason::no_such_closure;
  if (!closure->forbidden) return DropReason::not_forbidden;
  ledger_.allow(*closure);
  observations_.put_back(std::exchange(closure->evidence, {}), Reason::allowed_again);
  look_at_all_again();
  return DropReason::none;
}

void Closures::look_at_all_again() {
  proposer_.forget();
  observations_.consider_again(tags_.patches());
}

// What was tried out and would be accepted, if nobody had forbidden it.
bool Closures::refuse_if_forbidden(World world, Entry& closure, const Map& tried) {
  const ClosureId id = closure.record.id;
  if (!ledger_.is_forbidden_id(id)) return refuse_as_forbidden(world, closure, tried);
  closure.forbidden = true;
  closure.record.joining = as_mapped(tried, closure.record.joining);
  ledger_.decide(closure, ClosureState::refused, Reason::forbidden);
  observations_.set_verdict(closure.evidence, Verdict::refused, Reason::forbidden, id);
  return true;
}

// What says once more what is forbidden already.
bool Closures::refuse_as_forbidden(World world, Entry& closure, const Map& tried) {
  const std::optional<ClosureId> forbidden = ledger_.forbidden_by(world.map, tried, world.options);
  if (!forbidden) return false;
  if (closure.record.from_scans) {
    closure.forbidden_as = *forbidden;
    ledger_.decide(closure, ClosureState::refused, Reason::forbidden);
    return true;
  }
  observations_.set_verdict(closure.evidence, Verdict::refused, Reason::forbidden, *forbidden);
  ledger_.keep_with_forbidden(*forbidden, std::move(closure.evidence));
  ledger_.strike(closure.record.id);
  return true;
}

void Closures::forget_robot(const std::string& robot) {
  if (const std::unique_ptr<Trial> trial = trials_.take()) put_off(ledger_.at(trial->proposal().id));
  observations_.forget_robot(robot);
  doubt_anew();
}

}  // namespace isthmus
