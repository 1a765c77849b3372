// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "frac/records/excitation.hpp"
#include "frac/records/record.hpp"

namespace frac {

/// A harmonic of the output over the fundamental of the input: a describing function of higher order (Nuij, Bosgra,
/// Steinbuch 2006).  Its phase is counted from that of the input times its order.
struct ResponseHarmonic {
  int order = 0;
  std::complex<double> value;                               // unit of the response
  double sigma = std::numeric_limits<double>::quiet_NaN();  // standard deviation of each part
};

/// Response at one frequency, with what is known of its error.
struct ResponsePoint {
  double omega = 0;            // rad/s
  std::complex<double> value;  // output per input
  /// Standard deviation of each part, the root of the mean of both variances: the whole deviation, noise and
  /// distortion. Error over sigma has variance 1, also where sigma itself comes from few degrees of freedom: it is the
  /// deviation of Student's distribution.
  double sigma = std::numeric_limits<double>::quiet_NaN();
  double sigma_re = std::numeric_limits<double>::quiet_NaN(), sigma_im = std::numeric_limits<double>::quiet_NaN();
  double correlation = 0;                                   // of the errors of both parts
  double degrees = 0;                                       // of freedom of sigma_re and sigma_im
  double input_amplitude = 0;                               // of the line, unit of the input
  double noise = std::numeric_limits<double>::quiet_NaN();  // share of sigma that is noise
  /// Share of sigma that is distortion, from lines that the excitation leaves out or from the scatter over
  /// realisations: of an excitation of odd lines alone that of odd order.  NaN: nothing tells it, and sigma holds noise
  /// alone.
  double distortion = std::numeric_limits<double>::quiet_NaN();
  /// Distortion of even order, which lies on other lines than an excitation of odd ones and is no part of sigma.
  double even_distortion = std::numeric_limits<double>::quiet_NaN();
  /// 95 % intervals of both: by chi-square, of lines that are complex normal and have the same power.
  double distortion_low = std::numeric_limits<double>::quiet_NaN(),
         distortion_high = std::numeric_limits<double>::quiet_NaN();
  double even_distortion_low = std::numeric_limits<double>::quiet_NaN(),
         even_distortion_high = std::numeric_limits<double>::quiet_NaN();
  double coherence = std::numeric_limits<double>::quiet_NaN();  // of an arbitrary input: squared, noise-free is 1
  std::complex<double> windowed{std::numeric_limits<double>::quiet_NaN(), 0};  // H1 of Hann windows, for comparison
  double periods = 0;   // of the input, in what the point is made of
  int subharmonic = 1;  // the motion repeats after so many periods of the input
  std::vector<ResponseHarmonic> harmonics;
  /// One clause where the point is not to be trusted; such a point has no sigma.
  std::string flag;

  /// sigma, or the rounding of the value where that is more: a deviation to weigh with also where all was exact.
  [[nodiscard]] double sigma_or_rounding() const;
  /// Half width of the 95 % interval of the real and of the imaginary part, by Student's distribution.
  [[nodiscard]] double half_width_re() const;
  [[nodiscard]] double half_width_im() const;
};

struct ResponseOptions {
  std::optional<Excitation> excitation;  // found where not told
  std::optional<double> period;          // s; found where not told
  int harmonics = 5;                     // of a stepped sine, >= 1
  /// s, by which outputs are read later than the input: e^{j omega delay} takes it out of the response.
  double sensor_delay = 0;
};

struct ResponseEstimate {
  Excitation excitation = Excitation::arbitrary;
  double period = std::numeric_limits<double>::quiet_NaN();  // s, of a periodic excitation
  double periods = 0;                                        // used, of each record
  std::size_t realisations = 1;
  std::vector<std::vector<ResponsePoint>> outputs;  // by output, omega rising (of a stepped sine: in order of time)
  std::vector<std::string> remarks;                 // for people, a sentence each

  /// Whether some point has a value and its deviation.
  [[nodiscard]] bool usable() const;
};

/// Frequency response of the outputs to the input, by an estimator that states its own error.
///
/// Periodic: the whole periods of the record as one discrete Fourier transform, whose lines between those of the period
/// hold noise and transient alone.  A polynomial of order 2 over the nearest 12 to 24 of them takes the transient away
/// and leaves the covariance of the noise of input and output together (Pintelon, Schoukens 2012, chapter 7; the
/// errors of both count).  Lines of the period that the excitation leaves out show distortion (ibid., chapter 4).
/// Stepped sine: the same for each segment, with harmonics.
/// Arbitrary: the local polynomial method of order 2 in response and transient (ibid., chapter 7), from the reference
/// to input and outputs where there is one; else over a common denominator of order 2 where that follows the lines
/// better (McKelvey, Guerin 2012).
///
/// Several records of equal length and period are realisations of one random excitation: value and deviation are then
/// those of the best linear approximation, mean and scatter over the realisations.
/// Gaps: a period of whole samples goes on over them, the segment of a stepped sine before and after one is one point
/// where both sides agree.
/// @throws std::invalid_argument  no record, records with other sample times or counts of outputs, harmonics < 1, a
///                                delay that is not finite, a period that is not positive or of which no record holds
///                                two, an arbitrary excitation with gaps.
[[nodiscard]] ResponseEstimate response(const std::vector<Record>& records, const ResponseOptions& options = {});

}  // namespace frac
