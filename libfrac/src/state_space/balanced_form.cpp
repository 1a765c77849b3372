// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "approximation/band_error.hpp"
#include "frac/state_space.hpp"
#include "model_on_band.hpp"

namespace frac {
namespace {

// Gramians of poles an octave apart are as ill-conditioned as Cauchy's matrix: 60 states take some 50 digits.
using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;

struct Complex {
  Real re = 0;
  Real im = 0;
};
Complex operator+(const Complex& a, const Complex& b) {
  return {a.re + b.re, a.im + b.im};
}
Complex operator*(const Complex& a, const Complex& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
Complex conjugate(const Complex& a) {
  return {a.re, -a.im};
}
Complex quotient(const Complex& a, const Complex& b) {
  const Real size = b.re * b.re + b.im * b.im;
  return {(a.re * b.re + a.im * b.im) / size, (a.im * b.re - a.re * b.im) / size};
}

template <typename Value>
class Square {
 public:
  explicit Square(std::size_t size) : size_(size), value_(size * size) {}
  Value& operator()(std::size_t i, std::size_t j) { return value_[i * size_ + j]; }
  const Value& operator()(std::size_t i, std::size_t j) const { return value_[i * size_ + j]; }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::size_t size_;
  std::vector<Value> value_;
};

struct Input {
  std::size_t state;
  Complex weight;
};

// Complex modal coordinates: x_i' = pole_i x_i + b_i u + sum of what enters from states before it; y = direct u +
// sum c_i x_i.  A pair is a block's states and, next to them, their conjugates.
struct ModalState {
  Complex pole;
  Complex b;
  Complex c;
  std::vector<Input> from;
  std::size_t step;  // 2 in a pair, else 1
};

struct ModalSystem {
  std::vector<ModalState> states;
  Real direct = 1;
};

// The output of the system is the input of the next stage.
void add_stage(ModalSystem& system, double direct, const std::vector<Mode>& modes, double centre) {
  std::vector<ModalState>& states = system.states;
  std::vector<Input> output;
  for (std::size_t i = 0; i < states.size(); ++i) {
    output.push_back({i, states[i].c});
    states[i].c = Complex{direct, 0} * states[i].c;
  }
  for (const Mode& mode : modes) {
    const bool pair = mode.pole.imag() != 0;
    const std::size_t step = pair ? 2 : 1;
    const Complex pole{Real(mode.pole.real()) / centre, Real(mode.pole.imag()) / centre};
    Real scale = 1;
    for (std::size_t k = 0; k < mode.residues.size(); ++k) {
      scale /= centre;
      const Complex b{k == 0 ? system.direct : Real(0), 0};
      const Complex c{Real(mode.residues[k].real()) * scale, Real(mode.residues[k].imag()) * scale};
      const auto inputs = [&] { return k == 0 ? output : std::vector<Input>{{states.size() - step, {1, 0}}}; };
      states.push_back({pole, b, c, inputs(), step});
      if (pair) states.push_back({conjugate(pole), b, conjugate(c), inputs(), step});
    }
  }
  system.direct *= direct;
}

ModalSystem modal_system(const RationalModel& model, double centre) {
  ModalSystem system;
  add_stage(system, model.direct, model.modes, centre);
  for (const RationalStage& stage : model.series) add_stage(system, stage.direct, stage.modes, centre);
  return system;
}

// A P + P A^H + b b^H = 0, from the top left on.
Square<Complex> controllability(const std::vector<ModalState>& states) {
  Square<Complex> p(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    for (std::size_t j = 0; j < states.size(); ++j) {
      Complex sum = states[i].b * conjugate(states[j].b);
      for (const Input& each : states[i].from) sum = sum + each.weight * p(each.state, j);
      for (const Input& each : states[j].from) sum = sum + p(i, each.state) * conjugate(each.weight);
      const Complex poles = states[i].pole + conjugate(states[j].pole);
      p(i, j) = quotient(sum, {-poles.re, -poles.im});
    }
  }
  return p;
}

// A^H Q + Q A + c^H c = 0, from the bottom right on.
Square<Complex> observability(const std::vector<ModalState>& states) {
  const std::size_t n = states.size();
  std::vector<std::vector<Input>> to(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (const Input& each : states[i].from) to[each.state].push_back({i, each.weight});
  }
  Square<Complex> q(n);
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = n; j-- > 0;) {
      Complex sum = conjugate(states[i].c) * states[j].c;
      for (const Input& each : to[i]) sum = sum + conjugate(each.weight) * q(each.state, j);
      for (const Input& each : to[j]) sum = sum + q(i, each.state) * each.weight;
      const Complex poles = conjugate(states[i].pole) + states[j].pole;
      q(i, j) = quotient(sum, {-poles.re, -poles.im});
    }
  }
  return q;
}

// With z, conj z replaced by Re z, Im z: `inverse` false for x = M z (P -> M P M^H), true for Q -> M^-H Q M^-1.
Square<Real> in_real_coordinates(Square<Complex> gramian, const std::vector<ModalState>& states, bool inverse) {
  const std::size_t n = states.size();
  // M = [1/2 1/2; -j/2 j/2]; M^-H = [1 1; -j j].
  const Real size = inverse ? Real(1) : Real(0.5);
  for (int side = 0; side < 2; ++side) {
    for (std::size_t i = 0; i < n; i += states[i].step) {
      if (states[i].step == 1) continue;
      for (std::size_t j = 0; j < n; ++j) {
        Complex& first = side == 0 ? gramian(i, j) : gramian(j, i);
        Complex& second = side == 0 ? gramian(i + 1, j) : gramian(j, i + 1);
        const Complex sum{size * (first.re + second.re), size * (first.im + second.im)};
        const Complex difference{size * (first.re - second.re), size * (first.im - second.im)};
        // Rows turn by -j, columns by its conjugate.
        const Complex turned =
            side == 0 ? Complex{difference.im, -difference.re} : Complex{-difference.im, difference.re};
        first = sum;
        second = turned;
      }
    }
  }
  Square<Real> real(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) real(i, j) = gramian(i, j).re;
  }
  return real;
}

// Lower factor of a positive definite matrix.
Square<Real> cholesky(const Square<Real>& matrix) {
  const std::size_t n = matrix.size();
  Square<Real> lower(n);
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = j; i < n; ++i) {
      Real sum = matrix(i, j);
      for (std::size_t k = 0; k < j; ++k) sum -= lower(i, k) * lower(j, k);
      if (i == j) {
        if (!(sum > 0))
          throw std::domain_error("balanced form: a mode is not reached or not seen, or two are too alike");
        lower(j, j) = sqrt(sum);
      } else {
        lower(i, j) = sum / lower(j, j);
      }
    }
  }
  return lower;
}

// Rotations V that make the columns of M V orthogonal (Hestenes 1958), by falling length.
struct Columns {
  Square<Real> mv;
  Square<Real> v;
  std::vector<Real> length;
};
Columns orthogonal_columns(Square<Real> m) {
  const std::size_t n = m.size();
  Square<Real> v(n);
  for (std::size_t i = 0; i < n; ++i) v(i, i) = 1;
  const Real negligible = Real("1e-60");
  for (int sweep = 0; sweep < 60; ++sweep) {
    bool turned = false;
    for (std::size_t a = 0; a + 1 < n; ++a) {
      for (std::size_t b = a + 1; b < n; ++b) {
        Real aa = 0, bb = 0, ab = 0;
        for (std::size_t i = 0; i < n; ++i) {
          aa += m(i, a) * m(i, a);
          bb += m(i, b) * m(i, b);
          ab += m(i, a) * m(i, b);
        }
        if (abs(ab) <= negligible * sqrt(aa * bb)) continue;
        turned = true;
        const Real zeta = (bb - aa) / (2 * ab);
        const Real t = (zeta >= 0 ? Real(1) : Real(-1)) / (abs(zeta) + sqrt(1 + zeta * zeta));
        const Real c = 1 / sqrt(1 + t * t);
        const Real s = c * t;
        for (Square<Real>* each : {&m, &v}) {
          for (std::size_t i = 0; i < n; ++i) {
            const Real first = (*each)(i, a);
            (*each)(i, a) = c * first - s * (*each)(i, b);
            (*each)(i, b) = s * first + c * (*each)(i, b);
          }
        }
      }
    }
    if (!turned) break;
  }
  std::vector<Real> length(n);
  for (std::size_t j = 0; j < n; ++j) {
    Real sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += m(i, j) * m(i, j);
    length[j] = sqrt(sum);
  }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return length[a] > length[b]; });
  Columns sorted{Square<Real>(n), Square<Real>(n), {}};
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = 0; i < n; ++i) {
      sorted.mv(i, j) = m(i, order[j]);
      sorted.v(i, j) = v(i, order[j]);
    }
    sorted.length.push_back(length[order[j]]);
  }
  return sorted;
}

Square<Real> product(const Square<Real>& a, bool transposed, const Square<Real>& b) {
  const std::size_t n = a.size();
  Square<Real> result(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < n; ++k) {
      const Real factor = transposed ? a(k, i) : a(i, k);
      if (factor == 0) continue;
      for (std::size_t j = 0; j < n; ++j) result(i, j) += factor * b(k, j);
    }
  }
  return result;
}

// The states Re z, Im z of the modal coordinates.
struct RealSystem {
  Square<Real> a;
  std::vector<Real> b;
  std::vector<Real> c;
};
RealSystem real_system(const std::vector<ModalState>& states) {
  const std::size_t n = states.size();
  Square<Complex> a(n);
  for (std::size_t i = 0; i < n; ++i) {
    a(i, i) = states[i].pole;
    for (const Input& each : states[i].from) a(i, each.state) = each.weight;
  }
  // z = x + j y, conj z = x - j y.
  for (std::size_t i = 0; i < n; i += states[i].step) {
    for (std::size_t k = 0; states[i].step == 2 && k < n; ++k) {
      const Complex first = a(k, i);
      const Complex second = a(k, i + 1);
      a(k, i) = first + second;
      a(k, i + 1) = {second.im - first.im, first.re - second.re};
    }
  }
  RealSystem system{Square<Real>(n), std::vector<Real>(n), std::vector<Real>(n)};
  for (std::size_t i = 0; i < n; i += states[i].step) {
    const ModalState& state = states[i];
    system.b[i] = state.b.re;
    system.c[i] = state.step == 1 ? state.c.re : Real(2 * state.c.re);
    for (std::size_t k = 0; k < n; ++k) system.a(i, k) = a(i, k).re;
    if (state.step == 1) continue;
    system.c[i + 1] = -2 * state.c.im;
    // The row of conj z is the conjugate of that of z.
    for (std::size_t k = 0; k < n; ++k) system.a(i + 1, k) = a(i, k).im;
  }
  return system;
}

}  // namespace

// The square root method (Laub, Heath, Paige, Ward 1987): P = Lp Lp^T, Q = Lq Lq^T, Lq^T Lp = U S V^T,
// x = Lp V S^-1/2 z.
BalancedForm balanced_form(const RationalModel& system) {
  if (!system.stable) {
    throw std::domain_error(
        "balanced form: a pole of the system is not left of the imaginary axis; needed is a stable one");
  }
  const detail::ModelOnBand on_band(system.model, system.band);
  const double centre = on_band.centre();
  const ModalSystem modal = modal_system(system, centre);
  const std::vector<ModalState>& states = modal.states;
  const std::size_t n = states.size();
  const Square<Real> lp = cholesky(in_real_coordinates(controllability(states), states, false));
  const Square<Real> lq = cholesky(in_real_coordinates(observability(states), states, true));
  const Columns columns = orthogonal_columns(product(lq, true, lp));
  Square<Real> to_state = product(lp, false, columns.v);
  Square<Real> from_state(n);
  // S^-1/2 U^T Lq^T = S^-3/2 (M V)^T Lq^T.
  for (std::size_t i = 0; i < n; ++i) {
    const Real root = sqrt(columns.length[i]);
    for (std::size_t j = 0; j < n; ++j) {
      to_state(j, i) /= root;
      Real sum = 0;
      for (std::size_t k = 0; k < n; ++k) sum += columns.mv(k, i) * lq(j, k);
      from_state(i, j) = sum / (root * columns.length[i]);
    }
  }
  const RealSystem real = real_system(states);
  const Square<Real> a = product(from_state, false, product(real.a, false, to_state));
  BalancedForm result;
  StateSpace& form = result.system;
  form.states = n;
  form.d = static_cast<double>(modal.direct);
  const Real root_centre = sqrt(Real(centre));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) form.a.push_back(static_cast<double>(Real(a(i, j) * centre)));
    Real b = 0;
    Real c = 0;
    for (std::size_t k = 0; k < n; ++k) {
      b += from_state(i, k) * real.b[k];
      c += real.c[k] * to_state(k, i);
    }
    form.b.push_back(static_cast<double>(Real(b * root_centre)));
    form.c.push_back(static_cast<double>(Real(c * root_centre)));
    result.hankel_singular_values.push_back(static_cast<double>(columns.length[i]));
  }
  result.max_relative_error = detail::band_error(on_band.grid(3), [&](double omega) {
                                return form.response(omega) / on_band.response(omega);
                              }).relative;
  return result;
}

}  // namespace frac
