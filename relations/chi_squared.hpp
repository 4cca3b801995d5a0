#pragma once

#include <array>
#include <cstddef>

namespace isthmus {

/// The bound that a χ² variable stays within with a probability in (0, 1): the squared distance, in sigmas,
/// of a true measurement with so many degrees of freedom. Throws std::domain_error outside.
double chi2_quantile(double probability, int degrees_of_freedom);

/// Such a probability with its bounds on a coordinate, a point and a pose, computed once.
class ChiSquaredTest {
 public:
  /// Throws std::domain_error where the probability is not within (0, 1).
  explicit ChiSquaredTest(double probability)
      : probability_(probability),
        bounds_{chi2_quantile(probability, 1), chi2_quantile(probability, 2), chi2_quantile(probability, 3)} {
  }

  double probability() const { return probability_; }

  /// Of 1 to 3 degrees of freedom. Throws std::out_of_range for others.
  double bound(int degrees_of_freedom) const {
    return bounds_.at(static_cast<std::size_t>(degrees_of_freedom) - 1);
  }

 private:
  double probability_;
  std::array<double, 3> bounds_;
};

}  // namespace isthmus
