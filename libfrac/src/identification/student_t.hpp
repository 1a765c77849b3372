#pragma once

namespace frac::detail {

/// t with P(|T| <= t) = 0.95 for Student's T; NaN for degrees_of_freedom < 1.
[[nodiscard]] double student_t_95(double degrees_of_freedom);

}  // namespace frac::detail
