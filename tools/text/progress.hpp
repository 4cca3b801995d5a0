#pragma once

#include <chrono>
#include <string>

namespace isthmus {

/// Shows how far a long piece of work is, on stderr and only where that is a terminal; the line is cleared at
/// the end.
class Progress {
 public:
  explicit Progress(std::string label);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `share` of the work done, 0 to 1. Cheap to call often: prints at most ten times a second.
  void update(double share);
  /// In words, where nobody can tell the share.
  void say(const std::string& what);

 private:
  bool is_due();
  void show(const std::string& what);

  std::string label_;
  bool terminal_ = false;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace isthmus
