#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/engine/estimator.hpp"

namespace isthmus {

struct EngineState;

/// The mapping engine: a deterministic function from a sequence of events to a manifold map. It has no clock,
/// no LCM and no threads that matter to its result. Not thread-safe: one thread calls it; readers take
/// copies.
class Engine final : public Estimator {
 public:
  explicit Engine(Configuration configuration = {});
  ~Engine() override;
  Engine(Engine&&) noexcept;
  Engine& operator=(Engine&&) noexcept;

  /// A ConfigurationEvent is taken only before every other event, and replaces the configuration. What a
  /// stranger sends is refused and has no effect on the map, so the journal need not hold it.
  Outcome handle(const Event& event) override;

  /// Whether it is odometry, a scan or a sighting of a robot that has not introduced itself.
  bool is_stranger(const Event& event) const override;

  /// Counts messages that never became events. `robot` may be empty.
  void count_dropped(const std::string& robot, DropReason reason, std::int64_t messages = 1) override;

  /// What remains to be done when no more events will come: waiting scans, queued work, the last fit.
  /// Returns the answers to scans that were still waiting.
  Outcome finish();
  /// The same in bounded pieces, of which each takes no longer than one search, one step of a trial or the
  /// fit of one island: false once all is done. Answers are added to `outcome`. Between pieces the map may be
  /// copied; events may come after the last.
  bool finish_step(Outcome& outcome) override;
  /// A word for people: what the next piece does.
  std::string_view finishing() const override;

  /// From now on robots are localised and the map changes no more. What is under way on it is finished first,
  /// as `finish` does.
  void freeze();
  bool is_frozen() const;
  /// Once it is frozen: robots that are not found on the map, and why.
  std::vector<LostRobot> lost_robots() const override;

  /// Whether work waits that a TickEvent would advance.
  bool has_queued_work() const override;

  const Configuration& configuration() const override;
  MapCopy copy() const override;

  /// The serialised state without the rows of the trajectory: an engine restored from it continues
  /// identically. Waits for jobs in other threads. Must not be called once the engine is frozen.
  std::vector<std::uint8_t> save() const;
  /// `trajectory` holds the rows there were. Throws std::runtime_error saying what is wrong with `saved`.
  static Engine restore(std::span<const std::uint8_t> saved, std::shared_ptr<TrajectoryStore> trajectory);

 private:
  std::unique_ptr<EngineState> state_;
};

}  // namespace isthmus
