// What sightings do to a map, and what they must not do: two robots of a small office that meet twice.
//
//      R2 v                      The office's corridor lies between their rooms; they pass in it,
//    ==========  corridor  ===   drive on to rooms they do not know, and pass again.
//      ^ R1

#include "tools/simulate/campaigns/sightings/sightings.hpp"
#include "tests/scenario/event_sequences.hpp"

namespace isthmus {
namespace {

std::string finished_sha256(const Events& events) { return map_sha256(map_events(events)); }

RelationComparison inter_error(const SimulatedRun& run, const MapCopy& map) {
  std::vector<ScanRelation> relations = sample_relations(run.truth, 1);
  std::erase_if(relations, [](const ScanRelation& r) { return r.robot1 == r.robot2; });
  return compare(relations, map, map);
}

std::map<std::string, int> verdicts(const MapCopy& map, const std::string& observer = "") {
  std::map<std::string, int> counts;
  for (const SightingRecord& record : map.sightings)
    if (observer.empty() || record.sighting.robot == observer)
      ++counts[std::string(record.verdict == Verdict::refused ? word(record.reason) : word(record.verdict))];
  return counts;
}

Event sighting(std::int64_t receive_utime, const std::string& robot, int barcode, std::int64_t utime,
               double range_m = 1, double bearing_rad = 0) {
  return {receive_utime, SightingEvent{robot, utime, barcode, range_m, 0.05, bearing_rad, 0.03}};
}

TEST(Sightings, TwoRobotsThatMeetAreOnOneIsland) {
  const MapCopy map = map_events(meeting().events);
  EXPECT_EQ(islands(map), 1U);
  const ClosureRecord merge = closure_of(map, 0);
  EXPECT_EQ(merge.kind, ClosureKind::merge);
  EXPECT_EQ(merge.state, ClosureState::accepted);
  EXPECT_EQ(merge.robots, (std::vector<std::string>{"R1", "R2"}));
  EXPECT_LT(merge.end_utime - merge.start_utime, 5'000'000);
  const auto count = verdicts(map);
  EXPECT_EQ(count.at("accepted"), static_cast<int>(map.sightings.size())) << "all are true";
  const RelationComparison inter = inter_error(meeting(), map);
  EXPECT_GT(inter.compared, 50U);
  EXPECT_EQ(inter.missing, 0U);
  // Along the corridor that they share, scans say little and sightings are good to some centimetres.
  EXPECT_LT(inter.mean_m, 0.08);
}

TEST(Sightings, BeforeTheyMeetTheRobotsAreOnTheirOwnIslands) {
  Played early = play(meeting().events, after_s(meeting().events, 9));
  EXPECT_EQ(islands(early.engine.copy()), 2U);
  EXPECT_TRUE(early.engine.copy().closures.empty());
}

TEST(Sightings, AMergesRelationsSayWhichClosureTheyCameFrom) {
  const MapCopy map = map_events(meeting().events);
  std::size_t of_closures = 0;
  for (const auto& [id, relation] : map.graph.relations()) {
    const bool by_closure = relation.origin.kind == OriginKind::sighting ||
                            relation.origin.kind == OriginKind::hypothesis ||
                            relation.origin.kind == OriginKind::propagation;
    EXPECT_EQ(relation.origin.closure.valid(), by_closure) << name(relation.origin.kind);
    of_closures += by_closure ? 1 : 0;
  }
  EXPECT_GE(relations_of(map, ClosureId{0}), 3U);
  std::size_t sum = 0;
  for (const ClosureRecord& closure : map.closures) sum += relations_of(map, closure.id);
  EXPECT_EQ(sum, of_closures);
}

TEST(Sightings, SameEventsGiveTheSameMapToTheByte) {
  const std::string once = finished_sha256(meeting().events);
  EXPECT_EQ(once, finished_sha256(meeting().events));
  EXPECT_NE(once, finished_sha256(simulate(load_scenario("meeting"), 2).events));
}

// The same robots, deaf to one another, make other maps: the tests of identity above compare something.
TEST(Sightings, WithoutThemThereAreTwoIslands) {
  Events deaf = meeting().events;
  std::erase_if(deaf, [](const Event& e) { return std::holds_alternative<SightingEvent>(e.body); });
  const MapCopy map = map_events(deaf);
  EXPECT_EQ(islands(map), 2U);
  EXPECT_NE(map_sha256(map), finished_sha256(meeting().events));
}

TEST(BadSightings, AreRefusedWithTheReasonAndLeaveTheMapAsItWas) {
  const Events& clean = meeting().events;
  Events events = clean;
  const std::int64_t first = clean.front().receive_utime;
  // While nobody is in sight: a body seen a moment ago is kept by name.
  for (const double s : {4.0, 30.0}) {
    const std::int64_t now = after_s(clean, s);
    insert(events, sighting(now, "R1", 999, now));                  // nobody wears it, no tag has it
    insert(events, sighting(now, "R1", 101, now));                  // sees itself
    insert(events, sighting(now, "R7", 101, now));                  // nobody knows this robot
    insert(events, sighting(now, "R2", 101, first - 10'000'000));   // before the first scan
    insert(events, sighting(now, "R1", 102, now + 3'600'000'000));  // from the far future
    RobotEvent thief;
    thief.robot = "R3";
    thief.barcode = 101;
    insert(events, {now, thief});  // two robots with one barcode
  }
  Played played = play(events);
  played.engine.finish();
  const MapCopy map = played.engine.copy();
  const auto dropped = [&](DropReason reason) { return map.counters.dropped.at(reason); };
  EXPECT_EQ(dropped(DropReason::unknown_barcode), 2);
  EXPECT_EQ(dropped(DropReason::sees_itself), 2);
  EXPECT_EQ(dropped(DropReason::unknown_robot), 2);
  EXPECT_EQ(dropped(DropReason::barcode_taken), 2);
  EXPECT_EQ(map.counters.dropped_by_robot.at("R3").at(DropReason::barcode_taken), 2);
  EXPECT_EQ(played.drop_reasons.size(), 8U);
  const auto count = verdicts(map);
  EXPECT_EQ(count.at("unknown_barcode"), 2);
  EXPECT_EQ(count.at("sees_itself"), 2);
  EXPECT_EQ(count.at("unknown_robot"), 2);
  EXPECT_EQ(count.at("before_first_scan"), 2);
  EXPECT_EQ(count.at("stamp_in_future"), 2);
  EXPECT_EQ(count.at("accepted"), static_cast<int>(map.sightings.size()) - 10);
  Played plain = play(clean);
  plain.engine.finish();
  EXPECT_EQ(map_sha256(map), map_sha256(plain.engine.copy()));
}

// A live server does not journal what they send: a replay of the journal must give the same map all the same.
TEST(Strangers, HaveNoEffectOnTheMap) {
  const Events clean = meeting().events;
  Events events;
  for (const Event& event : clean) {
    events.push_back(event);
    const std::int64_t later = event.receive_utime + 5'000'000;
    events.push_back({later, OdometryEvent{"X", later, {}}});
    events.push_back({later, SightingEvent{"X", later, 101, 2, 0.1, 0.5, 0.02}});
  }
  EXPECT_EQ(finished_sha256(events), finished_sha256(clean));
}

TEST(BadSightings, ARobotWhoseBarcodeIsTakenIsNotThere) {
  Events events = meeting().events;
  const std::int64_t now = after_s(events, 4);
  RobotEvent thief;
  thief.robot = "R3";
  thief.barcode = 102;
  insert(events, {now, thief});
  insert(events, {now, OdometryEvent{"R3", now, {}}});
  Played played = play(events, after_s(events, 5));
  EXPECT_EQ(played.drop_reasons,
            (std::vector<DropReason>{DropReason::barcode_taken, DropReason::unknown_robot}));
}

// Before they meet, both robots tell three times of a meeting that was not, two seconds late, so that no
// body's beams are taken away: the trial of the merge is refused.
Events with_a_false_meeting(Events events) {
  const Events clean = events;
  for (const double s : {5.05, 5.55, 6.05}) {
    insert(events, sighting(after_s(clean, s + 2), "R1", 102, after_s(clean, s), 1.0, -1.5));
    insert(events, sighting(after_s(clean, s + 2), "R2", 101, after_s(clean, s), 1.0, 0));
  }
  return events;
}

TEST(RefusedTrials, LeaveTheMapByteIdentical) {
  Events clean = meeting().events;
  std::erase_if(clean, [&, end = after_s(clean, 9.5)](const Event& e) { return e.receive_utime > end; });
  const MapCopy map = map_events(with_a_false_meeting(clean));
  ASSERT_GE(map.closures.size(), 1U);
  for (const ClosureRecord& closure : map.closures) {
    EXPECT_EQ(closure.state, ClosureState::refused);
    EXPECT_NE(closure.reason, Reason::none);
    EXPECT_GT(closure.work_steps, 10) << "it was really tried";
    EXPECT_EQ(relations_of(map, closure.id), 0U);
  }
  for (const SightingRecord& record : map.sightings) EXPECT_EQ(record.verdict, Verdict::refused);
  EXPECT_EQ(islands(map), 2U);
  EXPECT_EQ(map_sha256(map), finished_sha256(clean));
}

TEST(RefusedTrials, OfALoopLeaveTheMapByteIdentical) {
  Events events = meeting().events;
  for (const double s : {45.05, 45.55, 46.05}) {
    const std::int64_t now = after_s(meeting().events, s);
    insert(events, sighting(now, "R1", 102, now));
    insert(events, sighting(now, "R2", 101, now));
  }
  const MapCopy map = map_events(events);
  ASSERT_EQ(state_of(map, 2), "refused");
  EXPECT_GT(closure_of(map, 2).work_steps, 0);
  EXPECT_EQ(verdicts(map).at("contradicts_map"), 6);
  EXPECT_EQ(map_sha256(map), finished_sha256(meeting().events));
}

TEST(RefusedTrials, DoNotKeepTheRobotsFromMergingWhenTheyTrulyMeet) {
  const MapCopy map = map_events(with_a_false_meeting(meeting().events));
  EXPECT_EQ(islands(map), 1U);
  EXPECT_EQ(state_of(map, 0), "refused");
  int of_false_meeting = 0;
  for (const SightingRecord& record : map.sightings) {
    if (record.sighting.bearing_sigma_rad != 0.03) continue;  // the simulator's own
    EXPECT_EQ(record.verdict, Verdict::refused);
    ++of_false_meeting;
  }
  EXPECT_EQ(of_false_meeting, 6);
  EXPECT_LT(inter_error(meeting(), map).mean_m, 0.08);
}

// R2 was in a radio shadow: all it has to tell comes late. R1's sightings of it have waited in vain; its own
// are paired with what is stored of R1.
TEST(LateData, OfAMinuteIsPairedWithStoredHistory) {
  const MapCopy map = map_events(delayed(meeting().events, "R2", 60'000'000));
  EXPECT_EQ(islands(map), 1U);
  const auto of_r2 = verdicts(map, "R2");
  EXPECT_EQ(of_r2.at("accepted"), 58);
  EXPECT_EQ(of_r2.size(), 1U);
  const auto of_r1 = verdicts(map, "R1");
  EXPECT_FALSE(of_r1.contains("accepted"));
  EXPECT_FALSE(of_r1.contains("waiting"));
  EXPECT_EQ(map.counters.scans, 2 * 298);
  EXPECT_LT(inter_error(meeting(), map).mean_m, 0.06);
}

TEST(LateData, OfTenMinutesIsMappedAndEverySightingHasAVerdict) {
  const Events late = delayed(meeting().events, "R2", 600'000'000);
  const MapCopy map = map_events(late);
  EXPECT_EQ(islands(map), 1U);
  EXPECT_EQ(map.counters.scans, 2 * 298);
  EXPECT_EQ(map.trajectory_rows, 2U * 298U);
  EXPECT_GE(verdicts(map, "R2").at("accepted"), 10);
  for (const SightingRecord& record : map.sightings) {
    EXPECT_TRUE(record.verdict == Verdict::accepted || record.verdict == Verdict::refused)
        << word(record.verdict);
    EXPECT_NE(record.reason, Reason::none);
  }
  EXPECT_EQ(map_sha256(map), finished_sha256(late));
}

TEST(LateData, OfASecondChangesNothingOfWhatIsFound) {
  const MapCopy map = map_events(delayed(meeting().events, "R2", 1'000'000));
  EXPECT_EQ(islands(map), 1U);
  EXPECT_EQ(verdicts(map).at("accepted"), static_cast<int>(map.sightings.size()));
}

}  // namespace
}  // namespace isthmus
