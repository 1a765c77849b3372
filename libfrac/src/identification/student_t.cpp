#include "student_t.hpp"

#include <boost/math/distributions/students_t.hpp>
#include <limits>

namespace frac::detail {

double student_t_95(double degrees_of_freedom) {
  if (!(degrees_of_freedom >= 1)) return std::numeric_limits<double>::quiet_NaN();
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.975);
}

}  // namespace frac::detail
