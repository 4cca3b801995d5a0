#include "relations/chi_squared.hpp"

#include <boost/math/distributions/chi_squared.hpp>

namespace isthmus {

double chi2_quantile(double probability, int degrees_of_freedom) {
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), probability);
}

}  // namespace isthmus
