#pragma once

#include <cstddef>
#include <memory>
#include <tuple>
#include <utility>

#include "server/engine/map/credit.hpp"
#include "server/engine/propagation/trial.hpp"
#include "server/engine/robot/world.hpp"

namespace isthmus {

/// Runs one trial at a time, in bounded steps on credit that grows with the time that passes, so that no
/// event waits long for a closure.
class TrialRunner {
 public:
  /// No trial may be running.
  void begin(World world, Proposal proposal);
  /// An event's share of the work. True: the trial was done at an event before; its result is to be taken and
  /// decided, which may take some milliseconds as its last step did.
  bool work(World world);
  /// One step, whatever the credit; waits for a job that has to end first.
  void step(World world) { trial_->finish_step(world.now_utime); }

  /// What is on trial; nothing where nothing is.
  const Trial* trial() const { return trial_.get(); }
  bool is_on_trial(ClosureId id) const { return trial_ && trial_->proposal().id == id; }
  std::unique_ptr<Trial> take() { return std::exchange(trial_, nullptr); }

  auto members() { return std::tie(trial_, credit_, patches_); }

 private:
  std::unique_ptr<Trial> trial_;
  Credit credit_;
  std::size_t patches_ = 0;  ///< of the map, when last worked
};

}  // namespace isthmus
