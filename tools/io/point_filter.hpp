#pragma once

#include <complex>
#include <string>
#include <string_view>

namespace io {

/// One comparison on a point of a frequency response, e.g. "im<0", "omega >= 10", "magnitude!=0".
/// Quantities: re, im, magnitude (unit of the data), omega (rad/s), f (Hz).  Operators: < <= > >= == !=.
class PointFilter {
 public:
  /// @throws std::invalid_argument  naming what was found and what is allowed.
  explicit PointFilter(std::string_view text);

  [[nodiscard]] bool operator()(double omega, std::complex<double> value) const;
  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  enum class Quantity { re, im, magnitude, omega, frequency };
  enum class Comparison { less, less_equal, greater, greater_equal, equal, not_equal };

  std::string text_;
  Quantity quantity_;
  Comparison comparison_;
  double bound_;
};

}  // namespace io
