#pragma once

namespace isthmus {

/// The bound that a χ² variable stays within with a probability in (0, 1): the squared distance, in sigmas,
/// of a true measurement with so many degrees of freedom. Throws std::domain_error outside.
double chi2_quantile(double probability, int degrees_of_freedom);

/// Such a bound with the probability it comes from, computed once.
class ChiSquaredBound {
 public:
  ChiSquaredBound(double probability, int degrees_of_freedom)
      : probability_(probability),
        degrees_of_freedom_(degrees_of_freedom),
        bound_(chi2_quantile(probability, degrees_of_freedom)) {}

  double probability() const { return probability_; }
  int degrees_of_freedom() const { return degrees_of_freedom_; }
  double value() const { return bound_; }

 private:
  double probability_;
  int degrees_of_freedom_;
  double bound_;
};

}  // namespace isthmus
