#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace isthmus {

/// Threads of the lowest priority, each for one connection at a time. Where all are busy, `add` waits: what
/// is not accepted yet takes no descriptor of this process.
class ConnectionPool {
 public:
  explicit ConnectionPool(std::size_t threads);
  ~ConnectionPool();

  void add(std::function<void()> connection);
  /// From now on `add` does not wait.
  void stop();
  /// Does what was added, and ends the threads.
  void finish();

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  std::size_t idle_ = 0;
  bool stopped_ = false;
  std::vector<std::jthread> threads_;  ///< last: they use all above
};

}  // namespace isthmus
