#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/campaigns/hostile/hostile.hpp"

namespace isthmus {
namespace {

struct HostileArguments : CampaignRuns {
  std::int64_t messages = 1'000'000;
  bool everyone = false;
};

void hostile_campaign(const HostileArguments& arguments) {
  for (const std::string& name : arguments.scenarios) {
    for (std::uint64_t seed = arguments.first_seed; seed < arguments.first_seed + arguments.seeds; ++seed) {
      const auto names = arguments.everyone ? HostileNames::everyone : HostileNames::intruder;
      const auto t = try_hostile_messages(arguments.load(name, seed), seed, arguments.messages, names);
      std::printf(
          "%s, seed %llu: %lld hostile messages, %.1f CPU s, %.0f MB at most; %zu patches of theirs\n",
          name.c_str(), static_cast<unsigned long long>(seed), static_cast<long long>(t.messages), t.cpu_s,
          t.peak_rss_mb, t.hostile_patches);
      for (const auto& [reason, count] : t.dropped)
        std::printf("  %-28s %9lld\n", std::string(word(reason)).c_str(), static_cast<long long>(count));
      std::printf("  the team's error: %.4f m over %zu relations (%.4f m without them), %zu not told (%zu)\n",
                  t.errors.mean_m, t.errors.compared, t.errors.mean_clean_m, t.errors.missing,
                  t.errors.missing_clean);
      std::fflush(stdout);
    }
  }
}

}  // namespace

void add_hostile_command(CLI::App& app) {
  const auto arguments = std::make_shared<HostileArguments>();
  CLI::App* hostile = app.add_subcommand(
      "hostile", "Maps runs through a server that hears messages that are spoilt between the team's.");
  arguments->add_scenarios(*hostile);
  arguments->add_runs(*hostile);
  hostile->add_option("--messages", arguments->messages, "Hostile messages in each run")
      ->capture_default_str();
  hostile->add_flag("--everyone", arguments->everyone,
                    "Well-formed ones in the name of every robot, and orders about their closures: their map "
                    "is not to be compared, the server is to live");
  hostile->callback([arguments] { hostile_campaign(*arguments); });
}

}  // namespace isthmus
