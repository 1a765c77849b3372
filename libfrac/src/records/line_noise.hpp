// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <functional>
#include <vector>

namespace frac::detail {

using Spectrum = std::vector<std::complex<double>>;

/// Lines of several channels at one frequency, without transient, and the covariance of their errors.
struct LineEstimate {
  Eigen::VectorXcd value;
  Eigen::MatrixXcd covariance;  // E e_a conj(e_b)
  Eigen::MatrixXcd relation;    // E e_a e_b: 0 for stationary noise
  double degrees = 0;           // complex ones, of the covariance; 0: too few lines around
  /// Lines as far below as above, so that the relation is known.
  bool is_symmetric = false;

  struct Parts {
    double variance_re, variance_im, covariance;
    double degrees;  // real ones, of each variance
  };
  /// Covariance of both parts of the error of a sum of weighted channels.
  [[nodiscard]] Parts parts(const Eigen::VectorXcd& weights) const;
};

/// A sum of weighted channels, and how what lies between the lines changes from line to line: the transient is a
/// polynomial times the response of the machine, the noise is divided by 1 - loop * response, as it goes round a loop.
struct ShapedSum {
  Eigen::VectorXcd weights;
  std::function<std::complex<double>(std::size_t)> response;  // at a bin; not finite: not known, and no shape is tried
  std::complex<double> loop;                                  // response from output to input; 0: there is none
};

/// Reads lines of several spectra of equal length without what leaks into them.
class LineReader {
 public:
  /// @param step        lines of the period are its multiples
  /// @param neighbours  lines on each side that are used; where one side has fewer, more of the other
  LineReader(const std::vector<Spectrum>& spectra, std::size_t step, std::size_t neighbours);

  /// Removes from the line `bin` of each spectrum the polynomial of order 2 that follows the lines around it which are
  /// no multiples of `step`, and estimates from what it leaves of them the covariance of the noise.
  /// The noise over the window is as large everywhere, or follows a power of frequency at low ones, or the shape of
  /// `sum`: as is likeliest of all channels, or of `sum` where it is given.  The polynomial is one times the shape of
  /// the transient of `sum`, where that leaves less of it.
  [[nodiscard]] LineEstimate operator()(std::size_t bin, const ShapedSum* sum = nullptr);

 private:
  /// Polynomial through the lines of a window whose noise has certain sizes.
  struct Fitted {
    Eigen::VectorXcd transient;      // at the line
    Eigen::MatrixXcd left;           // of the lines around, over the size of their noise relative to that at the line
    double leverage = 0;             // variance of the transient over that of the noise at the line
    double likelihood_of_sizes = 0;  // logarithm, the share that depends on the sizes alone
    double likelihood = 0;           // logarithm
  };
  /// What makes the polynomial of the lines, each over the size of its noise.
  struct Plan {
    Eigen::MatrixXd powers, to_terms;
  };
  [[nodiscard]] Plan plan(const Eigen::VectorXd& factors) const;
  /// @param inverse_sizes  of the noise of each line; none: as large everywhere
  /// @param shape          of the transient, 1 at the line; none: as large everywhere
  [[nodiscard]] Fitted fit(const Eigen::MatrixXcd& around, const Eigen::VectorXd& inverse_sizes,
                           const Eigen::VectorXcd& shape);
  [[nodiscard]] double largest_offset() const;
  void take_window(std::size_t bin);

  const std::vector<Spectrum>& spectra_;
  std::size_t step_, neighbours_;
  std::vector<std::ptrdiff_t> offsets_, planned_;  // pairs -r, r where the window is symmetric
  bool is_symmetric_ = true;
  Plan even_;  // of planned_, noise as large everywhere
};

/// Lines on each side for a record of so many periods: as many as there are to the next line of the period, where that
/// leaves at least 9 degrees of freedom (an interval of Student's distribution is then a sixth wider than the normal
/// one), and no more than 12, because response, noise and transient are to be smooth over them.
[[nodiscard]] std::size_t neighbours_for(std::size_t periods);

}  // namespace frac::detail
