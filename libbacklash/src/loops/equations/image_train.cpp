// SPDX-License-Identifier: BSD-3-Clause
#include "image_train.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "complex_quotient.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
// The limits of the strip about the path: the cut, at the angle pi/2, and the line of angle 0, beyond which the
// integrand grows.  Towards that the rule errs by e^{-2 pi 0.6/step} = 4e-17.  The other side is wider, as images of
// masses are as large as s^-5 near the origin, the tip of the cut.
constexpr double lowest_angle = 0.6;
constexpr double highest_angle = 0.7;
constexpr double nothing = 1e-18;

// Powers of s, whole ones by products.
class PowersOf {
 public:
  explicit PowersOf(Complex s) : s_(s) {}
  Complex operator()(double order) {
    constexpr int most = 8;
    if (order >= 0 && order <= most && order == std::round(order)) {
      Complex power = 1;
      for (int i = 0; i < static_cast<int>(order); ++i) power *= s_;
      return power;
    }
    if (!has_log_) {
      log_ = std::log(s_);
      has_log_ = true;
    }
    return std::exp(order * log_);
  }
  Complex operator()(const frac::detail::PowerProduct& product) {
    Complex value = 1;
    product.for_each_sum([&](const std::vector<frac::PowerTerm>& terms, int power) {
      Complex sum = 0;
      for (const frac::PowerTerm& term : terms) sum += term.coefficient * (*this)(term.order);
      for (int i = 0; i < power; ++i) value *= sum;
    });
    return value;
  }

 private:
  Complex s_;
  Complex log_ = 0;
  bool has_log_ = false;
};

// As it stands, or scaled where that leaves the range of numbers.
Complex image_at(const frac::detail::LaplaceImage& image, Complex s) {
  PowersOf powers(s);
  const Complex top = powers(image.numerator()), bottom = powers(image.denominator());
  const auto is_plain = [](double size) { return size > 1e-200 && size < 1e200; };
  if (is_plain(std::norm(top)) && is_plain(std::norm(bottom))) return quotient(top, bottom);
  return image.value(std::log(s));
}

}  // namespace

ImagePart::ImagePart(frac::detail::PowerProduct numerator, frac::detail::PowerProduct denominator, double of_delay)
    : image(std::make_shared<frac::detail::LaplaceImage>(std::move(numerator), std::move(denominator))),
      delay(of_delay) {
  const frac::detail::PowerSumRoots& roots = image->poles();
  if (!roots.complete) {
    throw std::invalid_argument("the poles of the loop between impacts could not be counted: " +
                                std::string(roots.trouble));
  }
  for (std::size_t k = 0; k < roots.clusters.size(); ++k) {
    const frac::detail::RootCluster& pole = roots.clusters[k];
    if (pole.log_s.imag() > pi) continue;
    // A circle in ln s about the pole, or about all of a cluster: its upper half where it is its own conjugate.  A
    // single pole needs the residue alone.  About several ones the circle is kept small, as s may come near.
    const bool is_single = pole.multiplicity == 1;
    const double radius = std::max(std::min(0.4 * image->clearance(k), is_single ? 0.2 : 0.02), 3 * pole.spread);
    constexpr int points = 64;
    Complex residue = 0;
    for (int i = 0; i < (pole.is_conjugate ? points / 2 : points); ++i) {
      const Complex offset = std::polar(radius, 2 * pi * (i + 0.5) / points);
      const Complex zeta = pole.log_s + offset;
      const Complex weight = image->value(zeta, zeta) * offset / static_cast<double>(points);
      residue += weight;
      if (!is_single) poles.push_back({std::exp(zeta), weight});
    }
    if (is_single) poles.push_back({std::exp(pole.log_s), pole.is_conjugate ? residue.real() : residue});
  }
}

// The share of a pole's residue that lies right of the path and in the error of the rule: 1 far right, 0 far left.
Complex ImageTrain::share_right(Complex parameter) const {
  return 1.0 / (1.0 + std::exp(Complex(0, -2 * pi / rule_.step) * parameter));
}

// The same left of it, of a point s.
Complex ImageTrain::share_left(Complex s) const {
  // The sine of its angle.
  const Complex turned = 1.0 - s * tau_;
  const double sine = 2 * turned.real() / (std::sqrt(std::norm(turned + 1.0)) + std::sqrt(std::norm(turned - 1.0)));
  if (sine < least_sine_) return 0;
  return 1.0 / (1.0 + std::exp(Complex(0, 2 * pi / rule_.step) * parameter(s)));
}

ImageTrain::ImageTrain(const ImagePart& part, double tau, double earliest, Rule rule)
    : part_(&part), tau_(tau), rule_(rule), first_(std::floor(part.delay / tau) + 1), age_(first_ * tau - part.delay) {
  choose_angle();
  for (const ImagePart::Exponential& pole : part_->poles) {
    const Complex share = share_right(parameter(pole.rate));
    if (std::abs(share) > nothing) add(pole.rate, pole.weight * share);
  }
  least_sine_ = std::sin(angle_ - 6 * rule_.step);
  add_contour(std::max(1e-9, std::min(earliest, age_ / tau)));
}

// Where on the path, and in the imaginary part how far left of it by angle.
Complex ImageTrain::parameter(Complex s) const {
  return Complex(0, 1) * (-std::asin(s * tau_ - 1.0) - angle_);
}

// The rule bears poles next to the path, but none at a node.
void ImageTrain::choose_angle() {
  std::vector<double> angles;
  for (const ImagePart::Exponential& pole : part_->poles) angles.push_back(-std::asin(pole.rate * tau_ - 1.0).real());
  double widest = -1;
  constexpr int choices = 13;
  for (int i = 0; i < choices; ++i) {
    const double angle = lowest_angle + (highest_angle - lowest_angle) * i / (choices - 1);
    double clearance = 1;
    for (const double pole : angles) clearance = std::min(clearance, std::abs(pole - angle));
    if (clearance > widest + 1e-9) {
      widest = clearance;
      angle_ = angle;
    }
  }
}

void ImageTrain::add(Complex r, Complex weight) {
  nodes_.push_back({r, weight, std::exp(r * tau_), weight * std::exp(r * age_)});
}

// (1/(2 pi j)) int Y e^{rt} dr, the upper half of the path; the lower one has the conjugate.
void ImageTrain::add_contour(double earliest) {
  const double sine = std::sin(angle_);
  const double cosine = std::cos(angle_);
  const double end = std::acosh((rule_.decayed / earliest + 1) / sine);
  const double last_begun = std::acosh((rule_.decayed * tau_ / age_ + 1) / sine);
  nodes_.reserve(nodes_.size() + static_cast<std::size_t>(end / rule_.step) + 1);
  for (double x = rule_.step / 2; x < end; x += rule_.step) {
    const double growing = std::exp(x), up = 0.5 * (growing + 1 / growing), along = 0.5 * (growing - 1 / growing);
    const Complex r = Complex(1 - sine * up, cosine * along) / tau_;
    const Complex slope = Complex(-sine * along, cosine * up) / tau_;
    add(r, image_at(*part_->image, r) * slope * rule_.step / Complex(0, 2 * pi));
    if (x < last_begun) begun_ = nodes_.size();
  }
}

std::array<Complex, 3> ImageTrain::sums(Complex s) const {
  return sums(s, true);
}

std::array<double, 3> ImageTrain::sums_of_one_sign() const {
  const std::array<Complex, 3> all = sums(0, false);
  return {all[0].real(), all[1].real(), all[2].real()};
}

std::array<Complex, 3> ImageTrain::sums(Complex s, bool with_zero) const {
  std::array<Complex, 3> total{};
  const Complex inverse_growth = std::exp(-s * tau_);
  const Complex begin = std::exp(-s * (first_ * tau_));
  const auto add = [&](Complex r, Complex part) {
    total[0] += part;
    part *= r;
    total[1] += part;
    total[2] += part * r;
  };
  for (std::size_t i = 0; i < begun_; ++i) {
    const Node& node = nodes_[i];
    add(node.r, quotient(node.begun, 1.0 - node.growth * inverse_growth));
    add(std::conj(node.r), quotient(std::conj(node.begun), 1.0 - std::conj(node.growth) * inverse_growth));
  }
  for (Complex& each : total) each *= begin;
  for (int n = -4; n <= 4; ++n) {
    if (n == 0 && !with_zero) continue;
    const Complex repeated = s + Complex(0, 2 * pi * n / tau_);
    const Complex share = share_left(repeated);
    if (std::abs(share) > nothing) {
      add(repeated, share * image_at(*part_->image, repeated) * std::exp(-repeated * part_->delay) / tau_);
    }
  }
  return total;
}

double ImageTrain::rate(const ImagePart& part, double tau) {
  return ImageTrain(part, tau, 1, fine).rate().value;
}

std::optional<double> ImageTrain::rough_rate(const ImagePart& part, double tau) {
  const Rate rate = ImageTrain(part, tau, 1, rough).rate();
  if (std::abs(rate.value) < 1e-3 * rate.size) return std::nullopt;
  return rate.value;
}

// At z = 1 the halves of the path are conjugate, and so are the frequencies of the alternation.
ImageTrain::Rate ImageTrain::rate() const {
  Rate rate{0, 0};
  const auto add = [&](Complex part) {
    rate.value += part.real();
    rate.size += std::abs(part.real());
  };
  const double sign = std::fmod(first_, 2) == 0 ? 2 : -2;
  for (std::size_t i = 0; i < begun_; ++i) {
    const Node& node = nodes_[i];
    add(sign * node.r * quotient(node.begun, 1.0 + node.growth));
  }
  for_each_turning_left(
      [&](Complex turning, Complex part) { add(turning * part * std::exp(-turning * part_->delay)); });
  return rate;
}

// Frequencies of the alternation on the side of the cut, with the response there: those nearest to the origin, if any.
template <typename Visit>
void ImageTrain::for_each_turning_left(const Visit& visit) const {
  for (int n = 1; n <= 7; n += 2) {
    const Complex turning(0, n * pi / tau_);
    const Complex share = share_left(turning);
    if (std::abs(share) < nothing) break;
    visit(turning, 2.0 / tau_ * share * image_at(*part_->image, turning));
  }
}

ImageTrain::Age ImageTrain::age_at(double t) const {
  const double age = age_ + t;
  return age > tau_ ? Age{age - tau_, first_ - 1} : Age{age, first_};
}

TrainWave ImageTrain::wave(double t) const {
  const auto [age, latest] = age_at(t);
  Complex value = 0;
  Complex slope = 0;
  for (const Node& node : nodes_) {
    if (node.r.real() * age < -rule_.decayed) continue;
    const Complex part = quotient(node.weight * std::exp(node.r * age), 1.0 + node.growth);
    value += part;
    slope += part * node.r;
  }
  const double sign = std::fmod(latest, 2) == 0 ? 2 : -2;
  TrainWave wave{sign * value.real(), sign * slope.real()};
  for_each_turning_left([&](Complex turning, Complex left) {
    const Complex part = left * std::exp(turning * (t - part_->delay));
    wave.value += part.real();
    wave.slope += (part * turning).real();
  });
  return wave;
}

std::array<double, 3> ImageTrain::repeated(double t) const {
  const double age = age_at(t).seconds;
  std::array<Complex, 3> total{};
  const auto add = [&](Complex rate, Complex part) {
    total[0] += part;
    total[1] += part * rate;
    total[2] += part * rate * rate;
  };
  for (const Node& node : nodes_) {
    if (node.r.real() * age < -rule_.decayed) continue;
    add(node.r, 2.0 * quotient(node.weight * std::exp(node.r * age), 1.0 - node.growth));
  }
  for (int n = 1; n <= 4; ++n) {
    const Complex turning(0, 2 * n * pi / tau_);
    const Complex share = share_left(turning);
    if (std::abs(share) < nothing) break;
    add(turning, 2.0 / tau_ * share * image_at(*part_->image, turning) * std::exp(turning * (t - part_->delay)));
  }
  return {total[0].real(), total[1].real(), total[2].real()};
}

TrainSplit ImageTrain::split(Complex s) const {
  const Complex share = share_left(s);
  const bool has_mean = std::abs(share) > nothing;
  return {sums(s, false),
          has_mean ? share * image_at(*part_->image, s) * std::exp(-s * part_->delay) / tau_ : Complex(0)};
}

}  // namespace backlash::detail
