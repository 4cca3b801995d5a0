#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <vector>

#include "server/wire/message/message.hpp"

namespace isthmus {

/// A robot's radio, which reaches its base as far as a range goes. What the robot says out of reach waits,
/// and goes out in order once it is back.
class Radio {
 public:
  /// Of what waits; the oldest is lost beyond it. Ten minutes of a robot.
  static constexpr std::size_t max_waiting = 50'000;

  /// A range of 0 reaches everywhere.
  Radio(const Eigen::Vector2d& base, double range_m) : base_(base), range_m_(range_m) {}

  bool reaches(const Eigen::Vector2d& point) const {
    return range_m_ == 0 || (point - base_).norm() <= range_m_;
  }

  /// Says something from a point: what goes out now.
  std::vector<Message> say(Message message, const Eigen::Vector2d& from);
  std::size_t lost() const { return lost_; }

 private:
  Eigen::Vector2d base_;
  double range_m_;
  std::deque<Message> waiting_;
  std::size_t lost_ = 0;
};

}  // namespace isthmus
