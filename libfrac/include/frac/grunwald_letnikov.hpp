// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace frac {

/// Weights w_k = (-1)^k binomial(order, k), k = 0 .. memory_length, of the Gruenwald-Letnikov difference
///   D^order f(n h) ~ h^-order sum_k w_k f((n - k) h)      (Podlubny 1999, eq. 7.23; first order accurate in h).
/// Relative error below 4 eps (1 + |order|) (10 + ln k), eps = 2.2e-16.
/// @throws std::invalid_argument  order not finite or |order| > 20, memory_length > 10^7.
[[nodiscard]] std::vector<double> grunwald_letnikov_weights(double order, std::size_t memory_length);

/// One of them, at any index up to 2^53: by the recurrence below 1000, from there by the expansion of
/// Gamma(index - order)/Gamma(index + 1) in powers of (index - order/2)^-2.  Relative error as above.
/// @throws std::invalid_argument  order as above; index above 2^53.
[[nodiscard]] double grunwald_letnikov_weight(double order, std::uint64_t index);

/// Frequency response of that difference as it will be deployed: sample time h (s), sum over k = 0 .. memory_length,
/// that is the present sample and the memory_length before it.  memory_length = 0 means all: ((1 - e^{-j omega
/// h})/h)^order.
/// @throws std::invalid_argument  order or memory_length as above, sample_time not positive and finite, omega not in
/// (0, pi/sample_time].
[[nodiscard]] std::complex<double> grunwald_letnikov_response(double order, double sample_time,
                                                              std::size_t memory_length, double omega);

/// The difference itself: order-`order` derivative of samples taken every sample_time seconds, zero before the first.
/// memory_length = 0 keeps all samples.  Cost is proportional to samples times memory length; a stream, or long memory:
/// see fractional_derivative.hpp.
/// @throws std::invalid_argument  as above, or a sample not finite (its index is named).
[[nodiscard]] std::vector<double> grunwald_letnikov_derivative(const std::vector<double>& samples, double order,
                                                               double sample_time, std::size_t memory_length = 0);

/// The same with all samples kept, by the fast Fourier transform.  What it gains in time it loses in accuracy: every
/// value errs by some roundings of the largest, not of its own.
/// @throws std::invalid_argument  as above; more than 10^7 samples.
[[nodiscard]] std::vector<double> grunwald_letnikov_derivative_by_fft(const std::vector<double>& samples, double order,
                                                                      double sample_time);

}  // namespace frac
