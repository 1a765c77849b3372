// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/linear_algebra.hpp"
#include "frac/cancellation.hpp"
#include "records/chirp_transform.hpp"
#include "records/estimators.hpp"
#include "special/distributions.hpp"

namespace frac::detail {
namespace {

using std::numbers::pi;

std::vector<double> without_mean(const std::vector<double>& signal) {
  double sum = 0;
  for (const double each : signal) sum += each;
  std::vector<double> result = signal;
  for (double& each : result) each -= sum / static_cast<double>(signal.size());
  return result;
}

/// H1 = S_yu/S_uu of Hann windows that overlap by half: the usual estimate, for comparison.
class WindowedResponse {
 public:
  WindowedResponse(const std::vector<double>& input, const std::vector<double>& output)
      : length_(input.size() / 4 / 2 * 2), cross_(length_ / 2), power_(length_ / 2) {
    const ChirpTransform transform(length_, static_cast<double>(length_), length_ / 2);
    std::vector<double> window(length_), u(length_), y(length_);
    for (std::size_t i = 0; i < length_; ++i)
      window[i] = 0.5 - 0.5 * std::cos(2 * pi * (static_cast<double>(i) + 0.5) / static_cast<double>(length_));
    for (std::size_t begin = 0; begin + length_ <= input.size(); begin += length_ / 2) {
      for (std::size_t i = 0; i < length_; ++i) {
        u[i] = window[i] * input[begin + i];
        y[i] = window[i] * output[begin + i];
      }
      const auto of_input = transform(u.data()), of_output = transform(y.data());
      for (std::size_t k = 0; k < cross_.size(); ++k) {
        cross_[k] += of_output[k] * std::conj(of_input[k]);
        power_[k] += std::norm(of_input[k]);
      }
    }
  }

  /// @param turns  per sample
  [[nodiscard]] std::complex<double> operator()(double turns) const {
    const double place = turns * static_cast<double>(length_);
    const auto below = std::min(static_cast<std::size_t>(place), cross_.size() - 2);
    const double share = place - static_cast<double>(below);
    return (1 - share) * cross_[below] / power_[below] + share * cross_[below + 1] / power_[below + 1];
  }

 private:
  std::size_t length_;
  std::vector<std::complex<double>> cross_;
  std::vector<double> power_;
};

// Lines of a window: a response and a transient of order 2 over a denominator of order 2 leave 9 degrees of freedom.
constexpr std::ptrdiff_t reach = 8;
constexpr Eigen::Index width = 2 * reach + 1;

/// Least squares of complex equations.
struct Solution {
  Eigen::VectorXcd terms;
  Eigen::VectorXcd left;  // of the right side
  double degrees;         // real ones
  double spread;          // variance of each part of the first term over that of each part of an equation

  /// Of each part of an equation.
  [[nodiscard]] double variance() const { return left.squaredNorm() / degrees; }
};

/// Columns of complex equations as those of real ones, of one size, because each has a unit of its own.
struct RealColumns {
  Eigen::MatrixXd columns;
  Eigen::VectorXd sizes;

  explicit RealColumns(const Eigen::MatrixXcd& of) : columns(2 * of.rows(), 2 * of.cols()) {
    columns << of.real(), -of.imag(), of.imag(), of.real();
    sizes = columns.colwise().norm().cwiseMax(1e-300);
    columns = columns * sizes.cwiseInverse().asDiagonal();
  }
};

/// @param estimator  rows that make the terms, in the sizes of the columns, of the right side
Solution solution_of(const Eigen::MatrixXcd& columns, const Eigen::VectorXcd& right, const Eigen::MatrixXd& estimator,
                     const Eigen::VectorXd& sizes) {
  const Eigen::Index rows = columns.rows(), terms = columns.cols();
  Eigen::VectorXd stacked(2 * rows);
  stacked << right.real(), right.imag();
  const Eigen::VectorXd found = (estimator * stacked).cwiseQuotient(sizes);
  Solution solution;
  solution.terms.resize(terms);
  solution.terms.real() = found.head(terms);
  solution.terms.imag() = found.tail(terms);
  solution.left = right - columns * solution.terms;
  solution.degrees = 2 * static_cast<double>(rows - terms);
  solution.spread = (estimator.row(0) / sizes(0)).squaredNorm();
  return solution;
}
/// Least squares; or, of an input that answers in a loop, its equations weighed by the terms of the reference in the
/// place of those of the input (instrumental variables; Pintelon, Schoukens 2012, chapter 9).  The noise knows nothing
/// of the reference, and what is left is noise that has not gone round the loop, whose peaks may be narrow beside the
/// window.
Solution solution_of(const Eigen::MatrixXcd& columns, const Eigen::VectorXcd& right,
                     const Eigen::MatrixXcd* instruments) {
  const RealColumns real(columns);
  if (!instruments) return solution_of(columns, right, PlainQr(real.columns).dual().transpose(), real.sizes);
  const Eigen::MatrixXd weights = RealColumns(*instruments).columns.transpose();
  return solution_of(columns, right, solve_square(weights * real.columns, weights), real.sizes);
}

/// The lines of a window, and where they stand: -1 to 1.
Eigen::VectorXcd window_of(const Spectrum& spectrum, std::size_t middle) {
  Eigen::VectorXcd lines(width);
  for (Eigen::Index i = 0; i < width; ++i)
    lines(i) = spectrum[middle - static_cast<std::size_t>(reach) + static_cast<std::size_t>(i)];
  return lines;
}

/// A response times the input and a transient, of order 2, over a common denominator 1 + d1 x + d2 x^2 where that is
/// asked for (McKelvey, Guerin 2012): exact for a resonance that is narrow beside the window.  Equations are divided by
/// the denominator of the round before (Sanathanan, Koerner 1963).  In a loop the output too knows the noise: its terms
/// have those of order 3 and 4 of the reference for instruments.
Solution local_fit(const Eigen::VectorXcd& input, const Eigen::VectorXcd& output, const Eigen::VectorXcd* reference,
                   bool has_denominator) {
  const Eigen::ArrayXcd x = Eigen::ArrayXd::LinSpaced(width, -1, 1).cast<std::complex<double>>();
  Eigen::ArrayXcd denominator = Eigen::ArrayXcd::Ones(width);
  const auto columns_of = [&](const Eigen::VectorXcd& signal, const Eigen::ArrayXcd& further) {
    const Eigen::ArrayXcd u = signal.array() / denominator, one = 1 / denominator;
    Eigen::MatrixXcd columns(width, has_denominator ? 8 : 6);
    columns.leftCols(6) << u, u * x, u * x.square(), one, one * x, one * x.square();
    if (has_denominator) columns.rightCols(2) << further / denominator * x, further / denominator * x.square();
    return columns;
  };
  Solution solution;
  for (int round = 0; round < (has_denominator ? 3 : 1); ++round) {
    const Eigen::VectorXcd right = output.array() / denominator;
    const Eigen::MatrixXcd columns = columns_of(input, -output.array());
    if (reference) {
      const Eigen::MatrixXcd instruments = columns_of(*reference, reference->array() * x.square());
      solution = solution_of(columns, right, &instruments);
    } else {
      solution = solution_of(columns, right, nullptr);
    }
    if (has_denominator) denominator = 1.0 + solution.terms(6) * x + solution.terms(7) * x.square();
  }
  return solution;
}

/// The rational one where its equations are left with so much less that 1 of 100 windows of noise alone would do so.
Solution local_response(const Eigen::VectorXcd& input, const Eigen::VectorXcd& output,
                        const Eigen::VectorXcd* reference = nullptr) {
  constexpr double chance = 0.01;
  Solution polynomial = local_fit(input, output, reference, false);
  Solution rational = local_fit(input, output, reference, true);
  const double ratio = polynomial.variance() / rational.variance();
  const bool is_better = std::isfinite(ratio) && std::isfinite(std::abs(rational.terms(0))) &&
                         fisher_f_above(ratio, polynomial.degrees, rational.degrees) < chance;
  return is_better ? rational : polynomial;
}

}  // namespace

Estimated arbitrary_response(const Record& record) {
  const std::size_t samples = record.size();
  const ChirpTransform transform(samples, static_cast<double>(samples), samples / 2);
  std::vector<std::vector<double>> signals{without_mean(record.input())};
  for (const auto& output : record.outputs()) signals.push_back(without_mean(output));
  const bool has_reference = !record.reference().empty();
  if (has_reference) signals.push_back(without_mean(record.reference()));
  std::vector<Spectrum> spectra;
  spectra.reserve(signals.size());
  for (const auto& signal : signals) spectra.push_back(transform(signal.data()));
  const Spectrum& drive = has_reference ? spectra.back() : spectra.front();
  const std::size_t outputs = record.outputs().size();
  std::vector<WindowedResponse> windowed;
  for (std::size_t output = 0; output < outputs; ++output) windowed.emplace_back(signals[0], signals[output + 1]);

  Estimated estimated;
  estimated.outputs.resize(outputs);
  double largest = 0;
  for (std::size_t i = 1; i < drive.size(); ++i) largest = std::max(largest, std::abs(drive[i]));
  // Windows side by side, so that the errors of the points are independent.
  for (std::size_t middle = reach + 1; middle + reach < drive.size(); middle += width) {
    throw_if_cancelled();
    const Eigen::VectorXcd of_drive = window_of(drive, middle);
    // What is left of a band without power is rounding.
    constexpr double rounding = 1e-12;
    const bool has_power = of_drive.norm() > rounding * largest;
    for (std::size_t output = 0; output < outputs; ++output) {
      ResponsePoint& point = estimated.outputs[output].emplace_back();
      const Eigen::VectorXcd of_output = window_of(spectra[output + 1], middle);
      const double turns = static_cast<double>(middle) / static_cast<double>(samples);
      point.omega = 2 * pi * turns / record.sample_time();
      point.periods = static_cast<double>(middle);
      point.windowed = windowed[output](turns);
      if (!has_power) {
        point.flag = "the input has no power here";
        continue;
      }
      const Eigen::VectorXcd of_input = window_of(spectra[0], middle);
      const Solution found = local_response(of_input, of_output, has_reference ? &of_drive : nullptr);
      point.value = found.terms(0);
      point.degrees = found.degrees;
      const double variance = found.variance();
      point.sigma = std::sqrt(variance * found.spread);
      std::complex<double> to_input = 1;
      if (has_reference) {
        const Solution from_reference = local_response(of_drive, of_input);
        to_input = from_reference.terms(0);
        // As for periodic records: 10 dB above its error, each part of which has this variance.
        if (!std::isfinite(std::abs(point.value)) ||
            !(std::norm(to_input) >= 10 * 2 * from_reference.variance() * from_reference.spread))
          point.flag = "the reference does not drive the input here";
      }
      // Of the input within the window, as the amplitude of a sine of its power.
      point.input_amplitude = of_drive.norm() * std::abs(to_input);
      point.sigma *= std::sqrt(student_variance(point.degrees));
      point.coherence =
          std::clamp(1 - variance / (of_output.squaredNorm() / (2 * static_cast<double>(width))), 0.0, 1.0);
      if (!point.flag.empty()) point.sigma = std::numeric_limits<double>::quiet_NaN();
      point.sigma_re = point.sigma_im = point.noise = point.sigma;
    }
  }
  return estimated;
}

}  // namespace frac::detail
