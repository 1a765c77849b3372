// SPDX-License-Identifier: BSD-3-Clause
#include "linear_flight.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/eigenvalues.hpp"
#include "base/linear_algebra.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;
using Matrix = Eigen::MatrixXd;

constexpr Index degree = 18;
// Size of what the polynomial leaves out.  It does so in every flight alike, so the size is far below a rounding.
constexpr double negligible = 1e-19;
// Looked at for one rise: a hundred times what flights take whose size is far above their rounding.
constexpr int most_intervals = 20'000;

// Number of slow ones among the eigenvalues by rising modulus: the widest gap above the pace decides.
Index slow_count(const std::vector<double>& moduli, double pace) {
  const auto size = static_cast<Index>(moduli.size());
  Index best = size;
  double widest = 1;
  for (Index i = 0; i < size; ++i) {
    const double next = moduli[static_cast<std::size_t>(i)];
    const double last = i > 0 ? moduli[static_cast<std::size_t>(i - 1)] : 0;
    if (next < 3 * pace || last > 10 * pace) continue;
    const double gap = next / std::max(last, 3 * pace);
    if (gap > widest) {
      widest = gap;
      best = i;
    }
  }
  return best;
}

// A matrix in other coordinates: the states are order * scale * those of the frame.
struct Frame {
  Eigen::VectorXd scale;
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, Index> order;
  Matrix matrix;
};

Frame in_sizes(const Matrix& a, const Eigen::VectorXd& sizes) {
  Frame frame{sizes, {}, {}};
  frame.order.setIdentity(sizes.size());
  // Powers of two, so that scaling rounds nothing.
  for (double& each : frame.scale) each = std::exp2(std::round(std::log2(each)));
  frame.matrix = frame.scale.cwiseInverse().asDiagonal() * a * frame.scale.asDiagonal();
  return frame;
}

// Realised powers of s have poles up to 1e9 times the pace, whose rounding would be as large as the slow eigenvalues.
// In this frame the fastest stand first, and rows are as large as columns (Osborne 1960): eigenvalues and vectors of
// such a graded matrix keep their own digits (Barlow, Demmel 1990).
Frame graded(Frame frame) {
  const Index size = frame.matrix.rows();
  Eigen::Matrix<Index, Eigen::Dynamic, 1>& order = frame.order.indices();
  std::stable_sort(order.begin(), order.end(),
                   [&](Index i, Index k) { return std::abs(frame.matrix(i, i)) > std::abs(frame.matrix(k, k)); });
  frame.matrix = (frame.order.transpose() * frame.matrix * frame.order).eval();
  frame.scale = (frame.order.transpose() * frame.scale).eval();
  constexpr int most_sweeps = 50;
  Matrix beside = frame.matrix;
  beside.diagonal().setZero();
  bool is_balanced = false;
  for (int sweep = 0; sweep < most_sweeps && !is_balanced; ++sweep) {
    is_balanced = true;
    for (Index i = 0; i < size; ++i) {
      const double column = beside.col(i).lpNorm<1>(), row = beside.row(i).lpNorm<1>();
      if (!(column > 0 && row > 0)) continue;
      const double factor = std::exp2(std::round(0.5 * std::log2(row / column)));
      if (factor == 1) continue;
      is_balanced = false;
      beside.col(i) *= factor;
      beside.row(i) /= factor;
      frame.scale[i] *= factor;
    }
  }
  beside.diagonal() = frame.matrix.diagonal();
  frame.matrix = beside;
  return frame;
}

// Eigenvectors of a matrix, and their places by rising modulus of the eigenvalue.
struct Modes {
  explicit Modes(const Matrix& matrix) : all(frac::detail::eigensystem(matrix)) {
    for (Index i = 0; i < matrix.rows(); ++i) order.push_back(i);
    std::sort(order.begin(), order.end(),
              [&](Index i, Index k) { return std::abs(all.values[i]) < std::abs(all.values[k]); });
  }

  // A pair is real and imaginary part of its upper vector, which stand at the places of both: eigenvalues that hardly
  // differ may come as a pair, of which rounding would leave one half that is not the mirror image of the other.
  [[nodiscard]] Eigen::VectorXd real_vector(Index rank) const {
    const Index i = order[static_cast<std::size_t>(rank)];
    if (all.values[i].imag() < 0) return all.vectors.col(i - 1).imag();
    return all.vectors.col(i).real();
  }

  frac::detail::Eigensystem all;
  std::vector<Index> order;
};

// The space of the fast modes, by columns and by rows with rows * columns = 1.
struct FastSpace {
  Index slow;  // number of the other modes
  Matrix columns, rows;
  bool has_given_up;  // modes that belong to it: their vectors coincide
};

FastSpace fast_space(const Modes& right, const Modes& left, double pace, double most_skew) {
  const auto size = static_cast<Index>(right.order.size());
  std::vector<double> moduli;
  for (const Index i : right.order) moduli.push_back(std::abs(right.all.values[i]));
  Index slow = slow_count(moduli, pace);
  // A pair is not parted.
  const auto parts_pair = [&] {
    return slow > 0 && slow < size &&
           moduli[static_cast<std::size_t>(slow)] - moduli[static_cast<std::size_t>(slow - 1)] <
               1e-9 * moduli[static_cast<std::size_t>(slow)];
  };
  while (parts_pair()) ++slow;
  const Index wanted = slow;
  Matrix columns, rows;
  for (;;) {
    const Index fast = size - slow;
    columns.resize(size, fast);
    rows.resize(fast, size);
    for (Index i = 0; i < fast; ++i) {
      columns.col(i) = right.real_vector(slow + i);
      rows.row(i) = left.real_vector(slow + i).transpose();
    }
    if (fast == 0) break;
    rows = frac::detail::solve_square(rows * columns, rows);
    Index worst = -1;
    for (Index i = 0; i < fast; ++i) {
      if (!(rows.row(i).norm() < most_skew)) worst = i;
    }
    if (worst < 0) break;
    slow += worst + 1;
    while (parts_pair()) ++slow;
  }
  return {slow, columns, rows, slow > wanted};
}

// A matrix with its modes, parted.
struct PartedFlight {
  PartedFlight(const Matrix& matrix_, double pace, double most_skew)
      : matrix(matrix_), modes(matrix_), fast(fast_space(modes, Modes(matrix_.transpose()), pace, most_skew)) {}

  Matrix matrix;
  Modes modes;
  FastSpace fast;
};

// Realised powers of s may share a pole far above the pace: eigenvalues equal to rounding, whose vectors are as good as
// one.  With the slow ones they would make flights as short as their own time.  A change of the diagonal by parts in
// 1e11, less than any realisation errs by, tells them apart.  Bodies that are no realisation allow less skew, and are
// left as they are.
PartedFlight parted(const Matrix& matrix, double pace, double most_skew) {
  PartedFlight result(matrix, pace, most_skew);
  if (!result.fast.has_given_up || most_skew < LinearFlight::realised_skew) return result;
  constexpr double change = 1e-11, golden = 0.6180339887498949;
  Matrix moved = matrix;
  for (Index i = 0; i < matrix.rows(); ++i) {
    const double turns = static_cast<double>(i) * golden;
    moved(i, i) *= 1 + change * (turns - std::floor(turns));
  }
  PartedFlight other(moved, pace, most_skew);
  return other.fast.slow < result.fast.slow ? other : result;
}

}  // namespace

LinearFlight::LinearFlight(const Matrix& a, double pace, const Eigen::VectorXd& sizes, double most_skew) {
  const Index size = a.rows();
  Frame frame = graded(in_sizes(a, sizes));
  const PartedFlight flight = parted(frame.matrix, pace, most_skew);
  const Modes& modes = flight.modes;
  const Index slow = flight.fast.slow;
  const Matrix &columns = flight.fast.columns, &rows = flight.fast.rows;
  const Index fast = size - slow;
  if (fast == 0) {
    // As they are: over a million flights the rounding of a change of basis would add up.
    frame = in_sizes(a, sizes);
    slow_basis_ = to_slow_ = Matrix::Identity(size, size);
    slow_ = frame.matrix;
  } else {
    // The slow space as a graph over some of the states: its matrix has no part of the large numbers of fast ones,
    // whose rounding would be as large as slow motions.
    const std::vector<Index> pivots = frac::detail::PivotedQr(rows).order();
    const std::vector<Index> led(pivots.begin(), pivots.begin() + fast), leading(pivots.begin() + fast, pivots.end());
    using frac::detail::chosen_columns;
    const Matrix graph = -frac::detail::solve_square(chosen_columns(rows, led), chosen_columns(rows, leading));
    slow_basis_.resize(size, slow);
    to_slow_.resize(slow, size);
    for (Index i = 0; i < fast; ++i) slow_basis_.row(led[static_cast<std::size_t>(i)]) = graph.row(i);
    for (Index i = 0; i < slow; ++i) {
      const Index place = leading[static_cast<std::size_t>(i)];
      slow_basis_.row(place) = Eigen::RowVectorXd::Unit(slow, i);
      to_slow_.row(i) = Eigen::RowVectorXd::Unit(size, place) - columns.row(place) * rows;
    }
    slow_ = Matrix(flight.matrix(leading, leading)) + Matrix(flight.matrix(leading, led)) * graph;
  }
  const Eigen::VectorXcd& values = modes.all.values;
  std::vector<Index> place(static_cast<std::size_t>(size), -1);
  for (Index i = 0; i < fast; ++i) {
    place[static_cast<std::size_t>(modes.order[static_cast<std::size_t>(slow + i)])] = i;
  }
  const auto is_kept = [&](Index i) { return place[static_cast<std::size_t>(i)] >= 0 && values[i].imag() >= 0; };
  Index count = 0;
  for (Index i = 0; i < size; ++i) count += is_kept(i);
  rates_.resize(count);
  fast_basis_.resize(size, count);
  to_fast_.resize(count, size);
  for (Index i = 0, k = 0; i < size; ++i) {
    if (!is_kept(i)) continue;
    rates_[k] = values[i];
    const Index at = place[static_cast<std::size_t>(i)];
    to_fast_.row(k) = rows.row(at).cast<Complex>();
    fast_basis_.col(k) = columns.col(at).cast<Complex>();
    if (rates_[k].imag() != 0) {
      const Index beside = place[static_cast<std::size_t>(i + 1)];
      to_fast_.row(k) = 0.5 * (to_fast_.row(k) - Complex(0, 1) * rows.row(beside).cast<Complex>()).eval();
      fast_basis_.col(k) += Complex(0, 1) * columns.col(beside).cast<Complex>();
    }
    ++k;
  }
  const Matrix to_frame = frame.scale.cwiseInverse().asDiagonal() * Matrix(frame.order.transpose());
  scale_ = frame.order * Eigen::VectorXd(frame.scale);
  slow_basis_ = frame.order * Matrix(slow_basis_);
  fast_basis_ = frame.order * Eigen::MatrixXcd(fast_basis_);
  to_slow_ = to_slow_ * to_frame;
  to_fast_ = to_fast_ * to_frame.cast<Complex>();
}

LinearFlight::Form LinearFlight::form(const Eigen::RowVectorXd& row) const {
  const Eigen::RowVectorXd scaled = row * scale_.asDiagonal();
  Form result{scaled * slow_basis_, scaled.cast<Complex>() * fast_basis_};
  for (Index i = 0; i < rates_.size(); ++i) {
    if (rates_[i].imag() != 0) result.fast[i] *= 2;
  }
  return result;
}

Matrix LinearFlight::transition(double t) const {
  // Slow modes by Taylor's series of a part 2^-halvings of the time, whose rest is below .5^19/19! = 2e-23, and
  // squares.
  const double size = slow_.norm() * std::abs(t);
  const int halvings = size > 0.5 ? static_cast<int>(std::ceil(std::log2(size / 0.5))) : 0;
  const Matrix part = slow_ * std::ldexp(t, -halvings);
  const Matrix one = Matrix::Identity(slow_.rows(), slow_.cols());
  Matrix slow = one;
  for (Index j = degree; j > 0; --j) slow = one + part * slow / static_cast<double>(j);
  for (int i = 0; i < halvings; ++i) slow = (slow * slow).eval();
  Matrix result = slow_basis_ * slow * to_slow_;
  for (Index i = 0; i < rates_.size(); ++i) {
    const Complex decay = rates_[i].imag() == 0 ? Complex(std::exp(rates_[i].real() * t)) : std::exp(rates_[i] * t);
    const double copies = rates_[i].imag() != 0 ? 2 : 1;
    result += copies * (fast_basis_.col(i) * decay * to_fast_.row(i)).real();
  }
  return scale_.asDiagonal() * result;
}

FlightPath::FlightPath(const LinearFlight& flight, const Eigen::VectorXd& state)
    : flight_(flight), taylor_(flight.slow_.rows(), degree + 1), fast_(flight.to_fast_ * state), horizon_(1e300) {
  taylor_.col(0) = flight.to_slow_ * state;
  for (Index j = 1; j <= degree; ++j) {
    taylor_.col(j).noalias() = flight.slow_ * taylor_.col(j - 1) / static_cast<double>(j);
  }
  const double size =
      taylor_.cols() > 0 ? taylor_.col(0).norm() + taylor_.col(1).norm() / (1e-300 + flight.slow_.norm()) : 0;
  for (const Index j : {degree - 1, degree}) {
    const double last = taylor_.col(j).norm();
    if (last > 0 && size > 0) {
      horizon_ = std::min(horizon_, std::pow(negligible * size / last, 1 / static_cast<double>(j)));
    }
  }
  decays_.reserve(8);
}

const Eigen::VectorXcd& FlightPath::decays(double t) const {
  for (const auto& [time, decay] : decays_) {
    if (time == t) return decay;
  }
  Eigen::VectorXcd decay(flight_.rates_.size());
  for (Index i = 0; i < decay.size(); ++i) {
    const Complex rate = flight_.rates_[i] * t;
    decay[i] = rate.real() < -45 ? Complex(0) : rate.imag() == 0 ? Complex(std::exp(rate.real())) : std::exp(rate);
  }
  if (decays_.size() < 8) {
    decays_.emplace_back(t, std::move(decay));
    return decays_.back().second;
  }
  next_ = (next_ + 1) % decays_.size();
  decays_[next_] = {t, std::move(decay)};
  return decays_[next_].second;
}

Eigen::VectorXd FlightPath::state(double t) const {
  Eigen::VectorXd slow = taylor_.col(degree);
  for (Index j = degree; j-- > 0;) slow = slow * t + taylor_.col(j);
  Eigen::VectorXd result = flight_.slow_basis_ * slow;
  const Eigen::VectorXcd& decay = decays(t);
  for (Index i = 0; i < decay.size(); ++i) {
    const Complex size = fast_[i] * decay[i];
    if (size == 0.0) continue;
    const double copies = flight_.rates_[i].imag() != 0 ? 2 : 1;
    result += copies * (flight_.fast_basis_.col(i) * size).real();
  }
  return flight_.scale_.asDiagonal() * result;
}

FlightPath::Signal::Signal(const FlightPath& path, const LinearFlight::Form& form, double sign, double offset)
    : path_(path), polynomial_(static_cast<std::size_t>(degree + 1)), fast_(path.fast_.size()) {
  for (Index j = 0; j <= degree; ++j) {
    polynomial_[static_cast<std::size_t>(j)] = sign * (form.slow * path.taylor_.col(j)).value();
  }
  polynomial_[0] += offset;
  for (Index i = 0; i < fast_.size(); ++i) fast_[i] = sign * form.fast[i] * path.fast_[i];
}

bool FlightPath::Signal::is_finite() const {
  double sum = 0;
  for (const double each : polynomial_) sum += std::abs(each);
  return std::isfinite(sum) && fast_.allFinite();
}

double FlightPath::Signal::value(double t) const {
  double sum = 0;
  for (std::size_t j = polynomial_.size(); j-- > 0;) sum = sum * t + polynomial_[j];
  const Eigen::VectorXcd& decay = path_.decays(t);
  for (Index i = 0; i < fast_.size(); ++i) sum += (fast_[i] * decay[i]).real();
  return sum;
}

double FlightPath::Signal::rate(double t) const {
  double sum = 0;
  for (std::size_t j = polynomial_.size(); j-- > 1;) sum = sum * t + static_cast<double>(j) * polynomial_[j];
  const Eigen::VectorXcd& decay = path_.decays(t);
  for (Index i = 0; i < fast_.size(); ++i) sum += (fast_[i] * path_.flight_.rates_[i] * decay[i]).real();
  return sum;
}

// The polynomial and what oscillates by two terms of Taylor and a bound of the next; what decays is monotone.
FlightPath::Signal::Range FlightPath::Signal::rates(double from, double to) const {
  const double width = to - from;
  double value = 0, slope = 0, bend = 0;
  for (std::size_t j = polynomial_.size(); j-- > 1;) {
    const auto power = static_cast<double>(j);
    value = value * from + power * polynomial_[j];
    if (j >= 2) slope = slope * from + power * (power - 1) * polynomial_[j];
    if (j >= 3) bend = bend * to + power * (power - 1) * (power - 2) * std::abs(polynomial_[j]);
  }
  Range decaying{0, 0};
  const Eigen::VectorXcd early = path_.decays(from);  // the next call may take its place
  const Eigen::VectorXcd& late = path_.decays(to);
  for (Index i = 0; i < fast_.size(); ++i) {
    const Complex rate = path_.flight_.rates_[i];
    if (rate.imag() == 0) {
      const double first = (fast_[i] * rate * early[i]).real();
      const double last = (fast_[i] * rate * late[i]).real();
      decaying.low += std::min(first, last);
      decaying.high += std::max(first, last);
      continue;
    }
    const Complex part = fast_[i] * rate;
    value += (part * early[i]).real();
    slope += (part * rate * early[i]).real();
    bend += std::abs(part * rate * rate) * std::exp(std::max(rate.real() * from, rate.real() * to));
  }
  const double curved = 0.5 * bend * width * width;
  return {value + std::min(0.0, slope * width) - curved + decaying.low,
          value + std::max(0.0, slope * width) + curved + decaying.high};
}

std::optional<double> FlightPath::Signal::first_rise(double from, double to) const {
  left_ = most_intervals;
  return first_rise(from, value(from), to, 0);
}

std::optional<double> FlightPath::Signal::first_rise(double from, double at_from, double to, int depth) const {
  const Range range = rates(from, to);
  // Beyond the range of numbers nothing can be said; the motion has diverged there.
  const bool is_bounded = std::isfinite(range.low) && std::isfinite(range.high);
  if (!is_bounded && !std::isfinite(value(to))) return std::nullopt;
  if (range.high <= 0 || at_from + range.high * (to - from) < 0) return std::nullopt;
  if (range.low > 0) {
    if (at_from > 0) return from;
    if (value(to) <= 0) return std::nullopt;
    return root(from, to);
  }
  // An extremum that touches 0 cannot be told from one that does not, and noise is no motion.
  if (depth == 50 || --left_ < 0) return value(to) > 0 ? std::optional(to) : std::nullopt;
  const double middle = 0.5 * (from + to);
  if (const auto early = first_rise(from, at_from, middle, depth + 1)) return early;
  return first_rise(middle, value(middle), to, depth + 1);
}

// Root of a rising function with a change of sign: Newton's method, kept inside by bisection.
double FlightPath::Signal::root(double low, double high) const {
  double t = 0.5 * (low + high);
  for (int i = 0; i < 100; ++i) {
    const double at = value(t);
    (at > 0 ? high : low) = t;
    double next = t - at / rate(t);
    if (!(next > low && next < high)) {
      // At a rounding from the root Newton steps onto an end.
      if (std::abs(next - t) <= 4e-16 * std::abs(t)) break;
      next = 0.5 * (low + high);
    }
    if (std::abs(next - t) <= 2e-16 * std::abs(t) || !(next > low && next < high)) {
      t = next;
      break;
    }
    t = next;
  }
  return t;
}

}  // namespace backlash::detail
