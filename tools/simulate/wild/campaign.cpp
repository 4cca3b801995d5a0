#include "tools/simulate/wild/campaign.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <type_traits>

#include "server/output/format/csv.hpp"
#include "server/output/output.hpp"
#include "server/wire/journal/event_log.hpp"
#include "tools/simulate/wild/site.hpp"

namespace isthmus {
namespace {

static_assert(std::is_trivially_copyable_v<WildTrial>);

void write_log(const SimulatedRun& run, const std::string& file) {
  EventLogWriter log(file);
  for (const Event& event : run.events) log.write(encode(event));
  log.finish();
}

void keep(const Scenario& scenario, const SimulatedRun& run, const std::string& directory) {
  write_truth(scenario, run, wild_relations(scenario, run.truth), directory + "/truth");
  write_log(run, directory + "/log.lcm");
}

/// A seed that is tried in a process of its own, which writes its trial into a pipe.
struct Child {
  std::uint64_t seed = 0;
  pid_t process = 0;
  int pipe = -1;
};

using Attempt = std::function<WildTrial(std::uint64_t)>;

[[noreturn]] void work(std::uint64_t seed, const Attempt& attempt, int pipe) {
  int code = 1;
  try {
    const WildTrial trial = attempt(seed);
    if (write(pipe, &trial, sizeof trial) == static_cast<ssize_t>(sizeof trial)) code = 0;
  } catch (const std::exception& error) {
    std::cerr << "seed " << seed << ": " << error.what() << '\n';
  }
  _exit(code);
}

Child begin(std::uint64_t seed, const Attempt& attempt) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  const pid_t process = fork();
  if (process < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (process == 0) {
    close(ends[0]);
    work(seed, attempt, ends[1]);
  }
  close(ends[1]);
  return {seed, process, ends[0]};
}

WildTrial end(const Child& child) {
  WildTrial trial;
  const bool told = read(child.pipe, &trial, sizeof trial) == static_cast<ssize_t>(sizeof trial);
  close(child.pipe);
  waitpid(child.process, nullptr, 0);
  if (!told) trial = WildTrial{};
  trial.seed = child.seed;
  return trial;
}

}  // namespace

WildTrial try_wild(std::uint64_t seed, const std::string& directory, const Configuration& configuration,
                   WildPlace place) {
  WildTrial trial;
  trial.seed = seed;
  trial.place = place;
  const double begin_s = process_cpu_s();
  const WildDraw draw = trial.draw();
  const Scenario scenario = make_wild_scenario(draw);
  const SimulatedRun run = simulate_wild(draw, scenario);
  for (const RobotTruth& robot : run.truth) trial.scans += robot.poses.size();
  trial.simulation_cpu_s = process_cpu_s() - begin_s;
  const MapCopy map = map_events(run.events, configuration);
  trial.cpu_s = process_cpu_s() - begin_s - trial.simulation_cpu_s;
  trial.score = judge_wild(scenario, run, map);
  const MapConfidence confidence = judge_confidence(map, run.truth, EngineOptions{}, MountSurvey{});
  trial.local_map = confidence.local.result();
  trial.island = confidence.island.result();
  trial.finished = true;
  if (trial.failed() && !directory.empty()) keep(scenario, run, directory + "/seed-" + std::to_string(seed));
  return trial;
}

void write_wild(const WildDraw& draw, const std::string& log, const std::string& truth) {
  const Scenario scenario = make_wild_scenario(draw);
  const SimulatedRun run = simulate_wild(draw, scenario);
  if (!truth.empty()) write_truth(scenario, run, wild_relations(scenario, run.truth), truth);
  if (!log.empty()) write_log(run, log);
}

void try_seeds(std::uint64_t first, std::uint64_t count, unsigned jobs, const Attempt& attempt,
               const std::function<void(const WildTrial&)>& done) {
  std::deque<Child> running;
  for (std::uint64_t next = first; next < first + count || !running.empty();) {
    if (next < first + count && running.size() < std::max(1U, jobs)) {
      running.push_back(begin(next++, attempt));
      continue;
    }
    const WildTrial trial = end(running.front());
    running.pop_front();
    done(trial);
  }
}

std::vector<WildTraitShare> compare_traits(const std::vector<WildTrial>& trials) {
  std::vector<WildTraitShare> shares;
  const auto failed = static_cast<double>(
      std::ranges::count_if(trials, [](const WildTrial& trial) { return trial.failed(); }));
  const double others = static_cast<double>(trials.size()) - failed;
  for (const WildTrial& trial : trials) {
    const std::vector<WildTrait> traits = traits_of(trial.draw());
    shares.resize(traits.size());
    for (std::size_t i = 0; i < traits.size(); ++i) {
      shares[i].name = traits[i].name;
      if (!traits[i].holds) continue;
      if (trial.failed()) {
        shares[i].of_failed += 1 / failed;
      } else {
        shares[i].of_others += 1 / others;
      }
    }
  }
  std::ranges::stable_sort(shares, std::ranges::greater(),
                           [](const WildTraitShare& one) { return one.of_failed - one.of_others; });
  return shares;
}

void write_wild_trials(const std::vector<WildTrial>& trials, const std::string& file) {
  CsvFile csv(
      file,
      "seed,finished,islands,relations,missing,mean_m,max_m,wrong_merges,missed_merges,true_sightings,"
      "true_accepted,false_sightings,false_accepted,local_map_nees,local_map_median_nees,island_nees,"
      "island_median_nees,scans,simulation_cpu_s,cpu_s,drawn,traits");
  for (const WildTrial& t : trials) {
    const WildDraw draw = t.draw();
    std::string traits;
    for (const WildTrait& trait : traits_of(draw))
      if (trait.holds) traits += (traits.empty() ? "" : ";") + trait.name;
    const WildScore& s = t.score;
    csv.row(t.seed, t.finished ? 1 : 0, s.islands, s.relations, s.missing, s.mean_m, s.max_m, s.wrong_merges,
            s.missed_merges, s.true_sightings, s.true_accepted, s.false_sightings, s.false_accepted,
            t.local_map.mean_nees, t.local_map.median_nees, t.island.mean_nees, t.island.median_nees, t.scans,
            t.simulation_cpu_s, t.cpu_s, describe(draw), traits);
  }
  csv.commit();
}

}  // namespace isthmus
