// What remains to be done at a log's end is done in pieces, and whoever looks at the map between them changes
// nothing; graphs that are written are read again.

#include <gtest/gtest.h>

#include <algorithm>

#include "server/engine/engine.hpp"
#include "server/output/tables/graph_g2o.hpp"
#include "server/output/tables/islands.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/simulate/run/simulation.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"
#include "tools/text/g2o.hpp"

namespace isthmus {
namespace {

/// The map of a scenario's first seconds, not finished yet.
Engine mapped(const std::string& scenario, double share) {
  const SimulatedRun run = simulate(load_scenario(scenario, {}), 1);
  Engine engine;
  const auto events = static_cast<std::size_t>(share * static_cast<double>(run.events.size()));
  for (std::size_t i = 0; i < events; ++i) engine.handle(run.events[i]);
  return engine;
}

TEST(Finish, InPiecesWithTheMapCopiedBetweenGivesTheSameMap) {
  int most = 0;
  for (const double share : {0.3, 0.5, 0.6, 0.8}) {
    SCOPED_TRACE(share);
    Engine whole = mapped("meeting", share), pieces = mapped("meeting", share);
    whole.finish();
    Outcome outcome;
    int count = 1;
    for (; pieces.finish_step(outcome); ++count) pieces.copy();
    most = std::max(most, count);
    EXPECT_EQ(map_sha256(pieces.copy()), map_sha256(whole.copy()));
  }
  EXPECT_GT(most, 5) << "nothing was left to be done";
}

TEST(Finish, AFinishedMapMayGoOnAndBeFinishedAgain) {
  Engine engine = mapped("meeting", 1);
  engine.finish();
  const std::string once = map_sha256(engine.copy());
  Outcome outcome;
  int pieces = 1;
  while (engine.finish_step(outcome)) ++pieces;
  EXPECT_LT(pieces, 100);
  EXPECT_EQ(map_sha256(engine.copy()), once);
}

TEST(GraphG2o, OfTeamsWithTagsAndWithoutLasersIsReadAgain) {
  for (const char* scenario : {"tags", "blind"}) {
    SCOPED_TRACE(scenario);
    Engine engine = mapped(scenario, 1);
    engine.finish();
    const MapCopy map = engine.copy();
    const TemporaryDirectory directory;
    write_g2o(map, rank_islands(map), directory / "graph.g2o");
    const G2oFile graph = read_g2o(directory / "graph.g2o");
    EXPECT_EQ(graph.edges.size(), map.graph.relations().size());
    EXPECT_EQ(graph.vertices.size(), map.patches.size());
  }
}

}  // namespace
}  // namespace isthmus
