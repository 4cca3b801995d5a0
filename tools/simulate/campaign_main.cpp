#include <CLI/CLI.hpp>

#include "server/program/command_line.hpp"
#include "tools/simulate/campaigns/command.hpp"
#include "tools/simulate/evidence/command.hpp"
#include "tools/simulate/wild/command.hpp"

int main(int argc, char** argv) {
  CLI::App app("Maps many simulated runs, and judges the maps by the truth.", "isthmus-campaign");
  app.require_subcommand(1);
  isthmus::add_confidence_command(app);
  isthmus::add_sightings_command(app);
  isthmus::add_closures_command(app);
  isthmus::add_hostile_command(app);
  isthmus::add_wild_command(app);
  isthmus::add_evidence_command(app);
  isthmus::add_features_command(app);
  isthmus::add_rendezvous_command(app);
  isthmus::add_floor_plans_command(app);
  isthmus::add_paths_command(app);
  isthmus::add_explore_command(app);
  isthmus::add_home_command(app);
  return isthmus::run_program(app, argc, argv);
}
