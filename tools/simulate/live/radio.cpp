#include "tools/simulate/live/radio.hpp"

#include <iterator>
#include <utility>

namespace isthmus {

std::vector<Message> Radio::say(Message message, const Eigen::Vector2d& from) {
  waiting_.push_back(std::move(message));
  if (waiting_.size() > max_waiting) {
    waiting_.pop_front();
    ++lost_;
  }
  if (!reaches(from)) return {};
  std::vector<Message> out(std::make_move_iterator(waiting_.begin()),
                           std::make_move_iterator(waiting_.end()));
  waiting_.clear();
  return out;
}

}  // namespace isthmus
