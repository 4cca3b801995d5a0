// What is withdrawn stays withdrawn, and takes with it all that depends on it: robots without a laser, tags,
// and closures that rest on one another. The reference is the run in which that closure was forbidden from
// the beginning.

#include <filesystem>

#include "server/engine/map/dependencies.hpp"
#include "server/output/tables/trajectories.hpp"
#include "tests/scenario/event_sequences.hpp"
#include "tests/support/recorded_data.hpp"
#include "tools/import/import.hpp"

namespace isthmus {
namespace {

using Together = std::set<std::pair<std::string, std::string>>;

/// The pairs of robots that have patches on one island.
Together robots_together(const MapCopy& map) {
  std::map<IslandId, std::set<std::string>> on;
  for (const PatchPtr& patch : map.patches)
    if (patch->tag < 0) on[map.graph.island(patch->id)].insert(patch->robot);
  Together together;
  for (const auto& [island, robots] : on)
    for (const std::string& a : robots)
      for (const std::string& b : robots)
        if (a < b) together.insert({a, b});
  return together;
}

std::size_t relations_between_robots(const MapCopy& map) {
  const auto robot = [&](PatchId id) { return map.patches[static_cast<std::size_t>(id.value)]->robot; };
  std::size_t count = 0;
  for (const auto& [id, relation] : map.graph.relations()) {
    const bool tag = map.patches[static_cast<std::size_t>(relation.b.value)]->tag >= 0;
    count += !tag && robot(relation.a) != robot(relation.b) ? 1 : 0;
  }
  return count;
}

std::size_t depending_on(const MapCopy& map, ClosureId closure) {
  const Dependencies dependencies(map.graph);
  std::size_t count = 0;
  for (const auto& [id, relation] : map.graph.relations()) count += dependencies.has(id, closure) ? 1 : 0;
  return count;
}

double seconds_of(const Events& events, std::int64_t utime) {
  return static_cast<double>(utime - events.front().receive_utime) * 1e-6;
}

ClosureId first_accepted(const MapCopy& map, ClosureKind kind) {
  for (const ClosureRecord& closure : map.closures)
    if (closure.kind == kind && closure.state == ClosureState::accepted) return closure.id;
  return {};
}

Events with_command(Events events, double at_s, Verb verb, ClosureId closure) {
  insert(events, command(after_s(events, at_s), verb, closure.value));
  return events;
}

MapCopy forbidden_from_the_beginning(Events events, ClosureId closure) {
  events.insert(events.begin(), command(events.front().receive_utime, Verb::forbid, closure.value));
  return map_events(events);
}

struct Team {
  SimulatedRun run;
  MapCopy plain;
  ClosureId merge;
  MapCopy reference;
  double merge_s = 0;
  double end_s = 0;
};

Team run_of(const std::string& scenario, std::uint64_t seed = 1) {
  Team its{simulate(load_scenario(scenario), seed), {}, {}, {}};
  its.plain = map_events(its.run.events);
  its.merge = first_accepted(its.plain, ClosureKind::merge);
  its.reference = forbidden_from_the_beginning(its.run.events, its.merge);
  its.merge_s = seconds_of(its.run.events, closure_of(its.plain, its.merge.value).end_utime);
  its.end_s = seconds_of(its.run.events, its.run.events.back().receive_utime);
  return its;
}

const Team& tags() {
  static const Team run = run_of("tags");
  return run;
}

const Team& blind() {
  static const Team run = run_of("blind");
  return run;
}

const Team& office() {
  static const Team run = run_of("office");
  return run;
}

std::vector<TrajectoryRow> rows_of(const MapCopy& map) {
  return map.trajectory->read(0, map.trajectory_rows);
}

/// Of what robots drove on others' patches without adding any, less is left than the reference has.
constexpr double worse_than_reference = 6;
/// What a match relates by, others took over meanwhile: about as many relations. A loop that is closed later
/// matches more at once, up to a sixth of all; with the merge there are a third more.
constexpr double as_many = 1.2;
constexpr double min_error_m = 0.01;

void expect_like_the_reference(const Team& run, const MapCopy& map) {
  EXPECT_EQ(robots_together(map), robots_together(run.reference));
  EXPECT_LE(static_cast<double>(relations_between_robots(map)),
            as_many * static_cast<double>(relations_between_robots(run.reference)));
  EXPECT_EQ(depending_on(map, run.merge), 0U);
  EXPECT_EQ(count_parted_rows(map), 0U) << "what a robot drove on another's ground is told by its own";
  const TrajectoryError error = judge_trajectories({run.run, map});
  const TrajectoryError reference = judge_trajectories({run.run, run.reference});
  std::printf("%.4f m, in the reference %.4f m\n", error.mean_m, reference.mean_m);
  EXPECT_LT(error.mean_m, worse_than_reference * std::max(reference.mean_m, min_error_m));
}

TEST(Withdrawn, MergeOfRobotsWithTagsPartsThemWheneverItComes) {
  ASSERT_TRUE(robots_together(tags().reference).empty());
  ASSERT_GT(depending_on(tags().plain, tags().merge), 100U);
  for (const double at_s : {tags().merge_s + 0.5, tags().merge_s + 20, tags().end_s - 0.2})
    expect_like_the_reference(
        tags(), map_events(with_command(tags().run.events, at_s, Verb::withdraw, tags().merge)));
}

// What says the same once more goes with it: that is what was forbidden.
TEST(Withdrawn, BothJoinsOfRobotsWithTagsLeaveNoRelationBetweenThem) {
  Events events = tags().run.events;
  for (const ClosureRecord& closure : tags().plain.closures)
    if (closure.robots.size() > 1 && closure.robots[1][0] == 'R' && closure.state == ClosureState::accepted)
      events = with_command(events, tags().end_s - 0.2, Verb::withdraw, closure.id);
  const MapCopy map = map_events(events);
  EXPECT_EQ(relations_between_robots(map), 0U);
  EXPECT_TRUE(robots_together(map).empty());
}

TEST(Withdrawn, MergeOfRobotsWithoutALaserPartsThemToTheEnd) {
  ASSERT_TRUE(robots_together(blind().reference).empty());
  for (const double at_s : {blind().merge_s + 0.5, blind().merge_s + 20, blind().end_s - 0.2}) {
    const Events events = with_command(blind().run.events, at_s, Verb::withdraw, blind().merge);
    Engine engine;
    std::int64_t look_utime = after_s(events, at_s);
    for (const Event& event : events) {
      engine.handle(event);
      if (event.receive_utime <= look_utime) continue;
      look_utime += 5'000'000;
      ASSERT_TRUE(robots_together(engine.copy()).empty()) << seconds_of(events, event.receive_utime) << " s";
    }
    engine.finish();
    expect_like_the_reference(blind(), engine.copy());
  }
}

TEST(Withdrawn, LoopTakesWhatRestedOnItAlong) {
  const ClosureId loop = first_accepted(blind().plain, ClosureKind::loop);
  ASSERT_TRUE(loop.valid());
  const Events events = with_command(blind().run.events, 30, Verb::withdraw, loop);
  Played played = play(events, after_s(events, 30));
  EXPECT_EQ(depending_on(played.engine.copy(), loop), 0U);
  EXPECT_EQ(state_of(played.engine.copy(), loop.value), "withdrawn");
}

TEST(Withdrawn, StaysSoAfterARestartFromASnapshot) {
  const double at_s = blind().merge_s + 20;
  const Events events = with_command(blind().run.events, at_s, Verb::withdraw, blind().merge);
  Engine uninterrupted;
  Engine restarted;
  for (const Event& event : events) {
    const bool is_withdrawal = std::holds_alternative<CommandEvent>(event.body);
    const auto rows = std::make_shared<TrajectoryStore>();
    if (is_withdrawal)  // as the journal has them, which wrote them down before
      for (const TrajectoryRow& row : rows_of(restarted.copy())) rows->append(row);
    uninterrupted.handle(event);
    restarted.handle(event);
    if (!is_withdrawal) continue;
    rows->flush();
    ASSERT_EQ(rows->size(), restarted.copy().trajectory_rows);
    restarted = Engine::restore(restarted.save(), rows);
  }
  uninterrupted.finish();
  restarted.finish();
  EXPECT_TRUE(robots_together(restarted.copy()).empty());
  EXPECT_EQ(map_sha256(restarted.copy()), map_sha256(uninterrupted.copy()));
  const std::vector<TrajectoryRow> rows = rows_of(uninterrupted.copy()), again = rows_of(restarted.copy());
  ASSERT_EQ(rows.size(), again.size());
  std::size_t differing = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool same =
        rows[i].patch == again[i].patch && rows[i].patch_from_robot == again[i].patch_from_robot;
    differing += same ? 0U : 1U;
  }
  EXPECT_EQ(differing, 0U);
}

TEST(Withdrawn, AndAllowedAgainComesBack) {
  for (const Team* run : {&tags(), &blind()}) {
    const double at_s = run->merge_s + 5;
    Events events = with_command(run->run.events, at_s, Verb::withdraw, run->merge);
    events = with_command(events, at_s + 5, Verb::allow, run->merge);
    const MapCopy map = map_events(events);
    EXPECT_EQ(robots_together(map), robots_together(run->plain));
    const double error = judge_trajectories({run->run, map}).mean_m;
    EXPECT_LT(error, worse_than_reference *
                         std::max(judge_trajectories({run->run, run->plain}).mean_m, min_error_m));
  }
}

// Four robots, three merges: the others' go on as in the reference.
TEST(Withdrawn, MergeAmongFourRobotsLeavesTheIslandsOfTheReference) {
  for (const double at_s : {office().merge_s + 20, office().end_s - 0.2})
    expect_like_the_reference(
        office(), map_events(with_command(office().run.events, at_s, Verb::withdraw, office().merge)));
}

// By other sightings, by tags, after their ways have drifted apart, and by whatever number it comes again.
TEST(Forbidden, MergeOfRobotsWithoutALaserStaysSoHoweverItIsFoundAgain) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Team run = run_of("blind", seed);
    ASSERT_TRUE(run.merge.valid());
    EXPECT_TRUE(robots_together(run.reference).empty()) << seed;
    EXPECT_EQ(relations_between_robots(run.reference), 0U) << seed;
    for (const ClosureRecord& closure : run.reference.closures)
      EXPECT_FALSE(closure.kind == ClosureKind::merge && closure.state == ClosureState::accepted)
          << seed << " " << closure.id.value;
  }
}

Events events_of_set(const std::string& name, int robots) {
  const std::string set = data_directory() + "/multi/" + name + "/";
  if (!std::filesystem::exists(set)) return {};
  CarmenImport what;
  for (int i = 1; i <= robots; ++i)
    what.logs.push_back({"R" + std::to_string(i), set + "r" + std::to_string(i) + ".clf.gz"});
  what.robots_csv = set + "robots.csv";
  what.sightings_csv = set + "sightings.csv";
  Events events;
  import_carmen(what, [&](const Event& event) { events.push_back(event); });
  return events;
}

TEST(Withdrawn, MergeOfARecordedTeamLeavesTheIslandsOfTheReference) {
  const Events events = events_of_set("intel-2", 2);
  if (events.empty()) GTEST_SKIP() << "no recorded data (ISTHMUS_DATA)";
  const MapCopy plain = map_events(events);
  const ClosureId merge = first_accepted(plain, ClosureKind::merge);
  ASSERT_TRUE(merge.valid());
  const MapCopy reference = forbidden_from_the_beginning(events, merge);
  ASSERT_TRUE(robots_together(reference).empty());
  const double end_s = seconds_of(events, events.back().receive_utime);
  const double merge_s = seconds_of(events, closure_of(plain, merge.value).end_utime);
  // In the end much of what R2 drove on is mapped by R1 alone, and its own patches have less to hold them.
  for (const auto& [at_s, max_m] : {std::pair(merge_s + 60, 0.15), std::pair(end_s - 1, 1.0)}) {
    const MapCopy map = map_events(with_command(events, at_s, Verb::withdraw, merge));
    EXPECT_EQ(robots_together(map), robots_together(reference)) << at_s;
    EXPECT_EQ(relations_between_robots(map), 0U) << at_s;
    const MapDifference difference = compare_patches(map, reference);
    std::printf("withdrawn at %.0f of %.0f s: %zu patches in both, at most %.3f m, %.4f rad off\n", at_s,
                end_s, difference.compared, difference.max_m, difference.max_rad);
    EXPECT_GT(difference.compared, 100U) << at_s;
    EXPECT_LT(difference.max_m, max_m) << at_s;
    EXPECT_LT(difference.max_rad, 0.1) << at_s;
  }
}

}  // namespace
}  // namespace isthmus
