#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace isthmus {

/// Random numbers that are the same with every standard library: std::mt19937_64 is specified to the bit, the
/// standard distributions are not, so deviates are made here. Each purpose draws from a stream of its own, so
/// that a change in one (a robot more, another scan rate) leaves the others as they were.
class Random {
 public:
  Random(std::uint64_t seed, std::string_view stream);

  double uniform();  ///< in [0, 1)
  double uniform(double low, double high);
  double normal();  ///< mean 0, sigma 1
  double normal(double sigma) { return sigma * normal(); }
  bool chance(double share) { return uniform() < share; }
  std::size_t index(std::size_t count);  ///< in [0, count); count > 0

 private:
  std::mt19937_64 engine_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace isthmus
