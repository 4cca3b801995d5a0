#include "server/wire/page/http/connection_pool.hpp"

#include <utility>

#include "server/wire/questions/low_priority.hpp"

namespace isthmus {

ConnectionPool::ConnectionPool(std::size_t threads) {
  for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back([this] { work(); });
}

ConnectionPool::~ConnectionPool() { finish(); }

void ConnectionPool::finish() {
  stop();
  threads_.clear();  // joins them
}

void ConnectionPool::add(std::function<void()> connection) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return stopped_ || waiting_.size() < idle_; });
  waiting_.push_back(std::move(connection));
  lock.unlock();
  changed_.notify_all();
}

void ConnectionPool::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
}

void ConnectionPool::work() {
  take_low_priority();
  std::unique_lock lock(mutex_);
  while (true) {
    idle_ += 1;
    changed_.notify_all();
    changed_.wait(lock, [&] { return stopped_ || !waiting_.empty(); });
    idle_ -= 1;
    if (waiting_.empty()) return;
    const std::function<void()> connection = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    connection();
    lock.lock();
  }
}

}  // namespace isthmus
