// Operators overrule closures: withdraw, forbid, allow, and measured starts. The scenario is two robots that
// meet (closure 0, a merge) and a while later meet again (closure 1, a loop of the merged island).

#include "tests/scenario/event_sequences.hpp"
#include "tools/simulate/campaigns/sightings/sightings.hpp"

namespace isthmus {
namespace {

/// A time of the run, and what the operator says then.
struct Said {
  double at_s;
  Verb verb;
  std::int64_t closure;
};

Events overruled(const std::vector<Said>& said) {
  Events events = meeting().events;
  for (const auto& [at_s, verb, closure] : said)
    insert(events, command(after_s(meeting().events, at_s), verb, closure));
  return events;
}

/// When a closure is on trial and a moment after it was accepted, where no operator says anything.
struct Trial {
  double amid_s;
  double accepted_s;
};

Trial trial_of(int closure) {
  static const MapCopy map = map_events(meeting().events);
  const ClosureRecord record = closure_of(map, closure);
  const auto seconds = [](std::int64_t utime) {
    return 1e-6 * static_cast<double>(utime - after_s(meeting().events, 0));
  };
  const double start_s = seconds(record.start_utime), end_s = seconds(record.end_utime);
  return {(start_s + end_s) / 2, end_s + 0.1};
}

double merged_s() { return trial_of(0).accepted_s; }

MapCopy forbidden_from_the_beginning() {
  Events events = meeting().events;
  events.insert(events.begin(), command(events.front().receive_utime, Verb::forbid, 0));
  return map_events(events);
}

void expect_every_patch_on_its_robots_island(const MapCopy& map) {
  for (const std::string robot : {"R1", "R2"}) EXPECT_EQ(islands_of(map, robot).size(), 1U) << robot;
}

TEST(Withdraw, RightAfterAcceptancePartsTheIslands) {
  const std::int64_t then = after_s(meeting().events, merged_s());
  const MapCopy accepted = play(meeting().events, then).engine.copy();
  ASSERT_EQ(state_of(accepted, 0), "accepted");
  Played played = play(overruled({{merged_s(), Verb::withdraw, 0}}), then);
  const MapCopy map = played.engine.copy();
  EXPECT_TRUE(played.drop_reasons.empty());
  EXPECT_EQ(state_of(map, 0), "withdrawn");
  EXPECT_EQ(relations_of(map, ClosureId{0}), 0U);
  EXPECT_EQ(islands(map), 2U);
  expect_every_patch_on_its_robots_island(map);
  int forbidden = 0;
  for (const SightingRecord& record : map.sightings)
    forbidden += record.verdict == Verdict::refused && record.reason == Reason::forbidden ? 1 : 0;
  EXPECT_EQ(forbidden, closure_of(accepted, 0).account.supporters);
}

// The reference is the run in which the closure was forbidden from the beginning. The difference: which
// patches were matched with which others while the islands were one, millimetres of poses, by which a patch
// that a robot makes later may be of another scan.
TEST(Withdraw, LeavesWhatForbiddingFromTheBeginningLeaves) {
  const MapCopy reference = forbidden_from_the_beginning();
  ASSERT_EQ(islands(reference), 2U);
  for (const double at_s : {merged_s(), merged_s() + 1, trial_of(1).amid_s - 1, trial_of(1).amid_s}) {
    const MapCopy map = map_events(overruled({{at_s, Verb::withdraw, 0}}));
    EXPECT_EQ(islands(map), 2U) << at_s;
    EXPECT_EQ(relations_of(map, ClosureId{0}), 0U) << at_s;
    expect_every_patch_on_its_robots_island(map);
    const MapDifference difference = compare_patches(map, reference);
    const MapDifference before = compare_patches(map, reference, after_s(meeting().events, at_s));
    std::printf("withdrawn at %.1f s: %zu patches, %zu in one map only, at most %.4f m, %.5f rad off\n", at_s,
                difference.compared, difference.only_in_one, difference.max_m, difference.max_rad);
    EXPECT_EQ(before.only_in_one, 0U) << at_s;
    EXPECT_LT(before.max_m, 0.01) << at_s;
    EXPECT_LT(before.max_rad, 0.003) << at_s;
    EXPECT_GT(difference.compared, 50U) << at_s;
    EXPECT_LT(difference.max_m, 0.02) << at_s;
    EXPECT_LT(difference.max_rad, 0.005) << at_s;
  }
}

// Two closures say the same; the islands part when neither holds them.
TEST(Withdraw, OfBothClosuresPartsTheIslandsLongAfterwards) {
  Played played =
      play(overruled({{40, Verb::withdraw, 0}, {40, Verb::withdraw, 1}}), after_s(meeting().events, 40));
  const MapCopy map = played.engine.copy();
  EXPECT_EQ(islands(map), 2U);
  EXPECT_EQ(relations_of(map, ClosureId{0}) + relations_of(map, ClosureId{1}), 0U);
  expect_every_patch_on_its_robots_island(map);
  for (const auto& [id, relation] : map.graph.relations())
    EXPECT_EQ(map.patches[static_cast<std::size_t>(relation.a.value)]->robot,
              map.patches[static_cast<std::size_t>(relation.b.value)]->robot);
}

TEST(Withdraw, IsRefusedForWhatIsNotAccepted) {
  Played plain = play(meeting().events);
  plain.engine.finish();
  const Events events = overruled({{1, Verb::withdraw, 0},  // not proposed yet
                                   {trial_of(0).amid_s, Verb::withdraw, 0},
                                   {30, Verb::withdraw, 17},
                                   {30, Verb::allow, 17},
                                   {30, Verb::allow, 0}});  // not forbidden
  Played played = play(events);
  played.engine.finish();
  EXPECT_EQ(played.drop_reasons,
            (std::vector<DropReason>{DropReason::no_such_closure, DropReason::not_accepted,
                                     DropReason::no_such_closure, DropReason::no_such_closure,
                                     DropReason::not_forbidden}));
  EXPECT_EQ(played.engine.copy().counters.dropped.at(DropReason::no_such_closure), 3);
  EXPECT_EQ(map_sha256(played.engine.copy()), map_sha256(plain.engine.copy()));
}

TEST(Withdraw, TwiceIsRefusedTheSecondTime) {
  Played played = play(overruled({{merged_s(), Verb::withdraw, 0}, {merged_s() + 0.4, Verb::withdraw, 0}}));
  EXPECT_EQ(played.drop_reasons, (std::vector<DropReason>{DropReason::not_accepted}));
}

TEST(Drop, TakesARobotsDataOutAndAllowBringsItBack) {
  const auto said = [](double at_s, Verb verb, const std::string& robot) {
    const std::int64_t utime = after_s(meeting().events, at_s);
    return Event{utime, CommandEvent{utime, verb, -1, robot}};
  };
  Events events = meeting().events;
  insert(events, said(40, Verb::drop, "R2"));
  Played dropped = play(events, after_s(meeting().events, 40.05));
  EXPECT_TRUE(dropped.drop_reasons.empty());
  const MapCopy without = dropped.engine.copy();
  ASSERT_FALSE(without.left_out.empty());
  for (const PatchId id : without.left_out) {
    EXPECT_EQ(without.patches[static_cast<std::size_t>(id.value)]->robot, "R2");
    EXPECT_TRUE(without.graph.of(id).empty());
  }
  EXPECT_EQ(islands_of(without, "R1").size(), 1U);

  insert(events, said(40.1, Verb::allow, "R2"));
  insert(events, said(40.2, Verb::allow, "R2"));
  insert(events, said(40.3, Verb::drop, "R9"));
  Played back = play(events, after_s(meeting().events, 40.35));
  EXPECT_EQ(back.drop_reasons, (std::vector<DropReason>{DropReason::not_dropped, DropReason::unknown_robot}));
  const MapCopy with = back.engine.copy();
  EXPECT_TRUE(with.left_out.empty());
  EXPECT_EQ(with.graph.island(PatchId{0}), with.graph.island(without.left_out.front()));

  // The rest of the run: R2 goes on, and the robots' maps are one again.
  const MapCopy whole = map_events(events);
  EXPECT_EQ(islands(whole), 1U);
}

TEST(Forbid, BeforehandKeepsTheIslandsApartHoweverOftenTheRobotsMeet) {
  const MapCopy map = forbidden_from_the_beginning();
  EXPECT_EQ(islands(map), 2U);
  ASSERT_FALSE(map.closures.empty());
  for (const ClosureRecord& closure : map.closures) {
    EXPECT_EQ(closure.state, ClosureState::refused);
    EXPECT_EQ(closure.reason, Reason::forbidden);
    EXPECT_EQ(relations_of(map, closure.id), 0U);
  }
  for (const SightingRecord& record : map.sightings) EXPECT_EQ(record.verdict, Verdict::refused);
  EXPECT_EQ(map_sha256(map), map_sha256(forbidden_from_the_beginning()));
}

TEST(Forbid, OfWhatIsOnTrialEndsTheTrial) {
  const MapCopy map = map_events(overruled({{trial_of(0).amid_s, Verb::forbid, 0}}));
  EXPECT_EQ(state_of(map, 0), "refused");
  EXPECT_EQ(closure_of(map, 0).reason, Reason::forbidden);
  EXPECT_EQ(islands(map), 2U);
}

TEST(Forbid, OfAnAcceptedClosureWithdrawsIt) {
  const MapCopy withdrawn = map_events(overruled({{merged_s(), Verb::withdraw, 0}}));
  const MapCopy forbidden = map_events(overruled({{merged_s(), Verb::forbid, 0}}));
  EXPECT_EQ(state_of(forbidden, 0), "withdrawn");
  EXPECT_EQ(map_sha256(forbidden), map_sha256(withdrawn));
}

TEST(Allow, AfterAWithdrawalMergesAgain) {
  for (const double again_s : {14.0, 59.0}) {
    const MapCopy map = map_events(overruled({{merged_s(), Verb::withdraw, 0}, {again_s, Verb::allow, 0}}));
    EXPECT_EQ(islands(map), 1U) << again_s;
    std::vector<ScanRelation> inter = sample_relations(meeting().truth, 1);
    std::erase_if(inter, [](const ScanRelation& r) { return r.robot1 == r.robot2; });
    const RelationComparison error = compare(inter, map, map);
    EXPECT_EQ(error.missing, 0U) << again_s;
    EXPECT_LT(error.mean_m, 0.06) << again_s;
  }
}

TEST(Allow, AfterForbiddingBeforehandMerges) {
  EXPECT_EQ(islands(map_events(overruled({{0, Verb::forbid, 0}, {30, Verb::allow, 0}}))), 1U);
  // And so early that nothing was forbidden yet, it is as if nothing had been said.
  EXPECT_EQ(map_sha256(map_events(overruled({{0, Verb::forbid, 0}, {5, Verb::allow, 0}}))),
            map_sha256(map_events(meeting().events)));
}

TEST(MeasuredStart, MergesTwoRobotsThatNeverSeeOneAnother) {
  Events deaf = meeting().events;
  std::erase_if(deaf, [](const Event& e) { return std::holds_alternative<SightingEvent>(e.body); });
  const Pose with_from_robot = ominus(meeting().truth.at(1).poses.front().world_from_robot,
                                      meeting().truth.at(0).poses.front().world_from_robot);
  Configuration configuration;
  configuration.robots["R2"].robot.robot = "R2";
  configuration.robots["R2"].start = MeasuredStart{"R1", with_from_robot, {0.05, 0.05, 0.02}};
  const MapCopy map = map_events(deaf, configuration);
  EXPECT_EQ(islands(map), 1U);
  ASSERT_FALSE(map.closures.empty());
  EXPECT_EQ(map.closures[0].kind, ClosureKind::merge);
  EXPECT_EQ(map.closures[0].state, ClosureState::accepted);
  EXPECT_EQ(map.closures[0].reason, Reason::measured_start);
  EXPECT_EQ(std::ranges::count(map.closures, ClosureKind::merge, &ClosureRecord::kind), 1);
  int starts = 0;
  for (const auto& [id, relation] : map.graph.relations())
    starts += relation.origin.kind == OriginKind::start ? 1 : 0;
  EXPECT_EQ(starts, 1);
  std::vector<ScanRelation> inter = sample_relations(meeting().truth, 1);
  std::erase_if(inter, [](const ScanRelation& r) { return r.robot1 == r.robot2; });
  const RelationComparison error = compare(inter, map, map);
  EXPECT_EQ(error.missing, 0U);
  EXPECT_LT(error.mean_m, 0.05);
}

// Two robots round one loop, whose maps merge by their scans before they ever see one another.
TEST(FromScans, AMergeIsWithdrawnAndForbiddenAsOneFromSightingsIs) {
  const SimulatedRun run = simulate(load_scenario("double_spiral"), 1);
  const MapCopy merged = map_events(run.events);
  ASSERT_FALSE(merged.closures.empty());
  const ClosureRecord& merge = merged.closures.front();
  ASSERT_EQ(merge.state, ClosureState::accepted);
  ASSERT_EQ(merge.reason, Reason::from_scans);
  EXPECT_GT(relations_of(merged, merge.id), 0U);

  Events withdrawn_events = run.events;
  insert(withdrawn_events, command(merge.end_utime + 1'000'000, Verb::withdraw, merge.id.value));
  const MapCopy withdrawn = map_events(withdrawn_events);
  EXPECT_EQ(state_of(withdrawn, merge.id.value), "withdrawn");
  EXPECT_EQ(relations_of(withdrawn, merge.id), 0U);
  EXPECT_EQ(islands(withdrawn), 2U) << "the sightings that follow say the same, which is forbidden";

  Events forbidden_events = run.events;
  forbidden_events.insert(forbidden_events.begin(),
                          command(run.events.front().receive_utime, Verb::forbid, merge.id.value));
  const MapCopy forbidden = map_events(forbidden_events);
  EXPECT_EQ(state_of(forbidden, merge.id.value), "refused");
  EXPECT_EQ(islands(forbidden), 2U);
}

}  // namespace
}  // namespace isthmus
