// SPDX-License-Identifier: BSD-3-Clause
#include "event_run.hpp"

#include <algorithm>
#include <span>

#include "base/wide_vectors.hpp"
#include "special/phi_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

/// What one gap without events does to the states: x <- e^z x + sum_i drive_i V_i, V_i the derivatives of the m-fold
/// integral of the input at its start.
struct Gap {
  double length;
  Eigen::ArrayXd change_re, change_im;  // e^z - 1
  Eigen::ArrayXXd drive;                // a column per channel
};

/// Gaps as they are asked for; those that are equal to rounding are prepared once.
class Gaps {
 public:
  explicit Gaps(const EventPlan& plan) : plan_(plan), phis_(plan.channels) { kept_.reserve(most_kept); }

  /// @param rounding  of its length
  const Gap& of(double length, double rounding) {
    for (const Gap& gap : kept_) {
      if (std::abs(gap.length - length) <= rounding) return gap;
    }
    if (kept_.size() < most_kept) {
      kept_.push_back(prepared(length));
      return kept_.back();
    }
    oldest_ = (oldest_ + 1) % most_kept;
    kept_[oldest_] = prepared(length);
    return kept_[oldest_];
  }

 private:
  static constexpr std::size_t most_kept = 12;

  Gap prepared(double length) {
    const Eigen::Index reals = plan_.real_count;
    const Eigen::Index complexes = plan_.complex_count;
    const auto channels = static_cast<Eigen::Index>(plan_.channels);
    const auto level = static_cast<Eigen::Index>(plan_.integrators);
    Gap gap{length, Eigen::ArrayXd(reals + complexes), Eigen::ArrayXd(complexes),
            Eigen::ArrayXXd::Zero(reals + 2 * complexes, channels)};
    for (Eigen::Index k = 0; k < reals + complexes; ++k) {
      const Complex z = plan_.rate[static_cast<std::size_t>(k)] * length;
      const Complex change = k < reals ? Complex(std::expm1(z.real())) : expm1(z);
      gap.change_re[k] = change.real();
      if (k >= reals) gap.change_im[k - reals] = change.imag();
      if (channels > 1) phi(z, phis_);
      const Eigen::Index first = plan_.is_direct[static_cast<std::size_t>(k)] ? level : 0;
      double power = 1;
      for (Eigen::Index i = first; i < channels; ++i, power *= length) {
        const Complex drive = i == first ? change : power * z * phis_[static_cast<std::size_t>(i - first)];
        gap.drive(k, i) = drive.real();
        if (k >= reals) gap.drive(k + complexes, i) = drive.imag();
      }
    }
    return gap;
  }

  const EventPlan& plan_;
  std::vector<Complex> phis_;
  std::vector<Gap> kept_;
  std::size_t oldest_ = 0;
};

/// Moves states over a gap, `width` of them at once.
template <std::size_t width>
FRACFIT_INLINE inline void move_states(const Gap& gap, std::size_t reals, std::size_t complexes,
                                       std::span<const double> input, double* state) {
  using L = Doubles<width>;
  using Vector = typename L::Type;
  const double* const change_re = gap.change_re.data();
  for (std::size_t k = 0; k < reals; k += width) L::at(state + k) += L::at(change_re + k) * L::at(state + k);
  for (std::size_t k = 0; k < complexes; k += width) {
    const Vector& by_re = L::at(change_re + reals + k);
    const Vector& by_im = L::at(gap.change_im.data() + k);
    Vector& re = L::at(state + reals + k);
    Vector& im = L::at(state + reals + complexes + k);
    const Vector old_re = re;
    re += by_re * old_re - by_im * im;
    im += by_im * old_re + by_re * im;
  }
  for (std::size_t i = 0; i < input.size(); ++i) {
    if (input[i] == 0) continue;
    const double* const drive = gap.drive.col(static_cast<Eigen::Index>(i)).data();
    for (std::size_t k = 0; k < reals + 2 * complexes; k += width) L::at(state + k) += input[i] * L::at(drive + k);
  }
}

/// sum[0, count width) = factors times rows of weights that many columns wide and `stride` apart.  Sums of every fourth
/// row go on side by side: that hides the time an addition takes.
template <std::size_t width, std::size_t count>
FRACFIT_INLINE inline void add_rows(std::span<const double> factor, const double* weight, std::size_t stride,
                                    double* sum) {
  using L = Doubles<width>;
  constexpr std::size_t together = EventPlan::together;
  typename L::Type part[together][count] = {};
  for (std::size_t k = 0; k < factor.size(); k += together) {
    for (std::size_t u = 0; u < together; ++u) {
      for (std::size_t c = 0; c < count; ++c) {
        part[u][c] += factor[k + u] * L::at(weight + (k + u) * stride + c * width);
      }
    }
  }
  for (std::size_t c = 0; c < count; ++c) {
    L::at(sum + c * width) = (part[0][c] + part[1][c]) + (part[2][c] + part[3][c]);
  }
}

template <std::size_t width>
FRACFIT_INLINE inline void add_rows(std::span<const double> factor, const double* weight, std::span<double> sum) {
  std::size_t j = 0;
  for (; j + 2 * width <= sum.size(); j += 2 * width) {
    add_rows<width, 2>(factor, weight + j, sum.size(), sum.data() + j);
  }
  for (; j < sum.size(); j += width) add_rows<width, 1>(factor, weight + j, sum.size(), sum.data() + j);
}

constexpr std::size_t narrow = 2, widest = 4;
static_assert(EventPlan::together == widest);

/// The states of the plan and the derivatives of the m-fold integral of the input, moved from instant to instant.
class States {
 public:
  States(const EventPlan& plan, double start)
      : reals_(static_cast<std::size_t>(plan.real_count)),
        complexes_(static_cast<std::size_t>(plan.complex_count)),
        level_(plan.integrators),
        gaps_(plan),
        now_(start),
        entries_(static_cast<std::size_t>(plan.weight.rows()), 0.0),
        input_(std::span(entries_).subspan(reals_ + 2 * complexes_, plan.channels)) {}

  /// What the rows of the plan's weights belong to.
  /// @param jump  of the input at this instant, which the states do not know of yet
  [[nodiscard]] std::span<const double> entries(double jump) {
    *(input_.data() + input_.size()) = jump;
    return entries_;
  }

  void advance(double to) {
    if (to <= now_) return;
    const double length = to - now_;
    const Gap& gap = gaps_.of(length, rounding_at(now_ + length));
    now_ = to;
    if (!is_moved_) return;
    if (instruction_set() == InstructionSet::plain) {
      move_states<narrow>(gap, reals_, complexes_, input_, entries_.data());
    } else {
      with_wide_vectors([&]()
                            FRACFIT_INLINE { move_states<widest>(gap, reals_, complexes_, input_, entries_.data()); });
    }
    integrate_input(length);
  }

  void apply(const EventResponse::Knot& knot) {
    input_[level_] += knot.jump;
    if (level_ + 1 < input_.size()) input_[level_ + 1] += knot.slope;
    is_moved_ = is_moved_ || std::any_of(input_.begin(), input_.end(), [](double each) { return each != 0; });
  }

 private:
  void integrate_input(double length) {
    for (std::size_t i = 0; i < input_.size(); ++i) {
      double factor = 1;
      for (std::size_t j = i + 1; j < input_.size(); ++j) {
        factor *= length / static_cast<double>(j - i);
        input_[i] += factor * input_[j];
      }
    }
  }

  std::size_t reals_, complexes_, level_;
  Gaps gaps_;
  double now_;
  AlignedVector<double> entries_;
  std::span<double> input_;  // of the entries
  bool is_moved_ = false;    // whether any input has come
};

/// Turns states into outputs.
class Outputs {
 public:
  Outputs(const EventPlan& plan, Eigen::Index rows, EventResponse::Result& result)
      : plan_(plan), result_(result), row_(static_cast<std::size_t>(plan.weight.cols())) {
    result.value.resize(rows);
    result.gradient.resize(rows, plan.columns - 1);
  }

  /// @param entries  what the rows of the plan's weights belong to
  void add(std::span<const double> entries) {
    if (instruction_set() == InstructionSet::plain) {
      add_rows<narrow>(entries, plan_.weight.data(), row_);
    } else {
      with_wide_vectors([&]() FRACFIT_INLINE { add_rows<widest>(entries, plan_.weight.data(), row_); });
    }
    result_.value[written_] = row_[0];
    for (Eigen::Index p = 0; p < result_.gradient.cols(); ++p) {
      result_.gradient(written_, p) = row_[static_cast<std::size_t>(p) + 1];
    }
    ++written_;
  }

 private:
  const EventPlan& plan_;
  EventResponse::Result& result_;
  Eigen::Index written_ = 0;
  AlignedVector<double> row_;  // of one instant, filled up as the weights are
};

}  // namespace

void run_over_events(const EventPlan& plan, const std::vector<EventResponse::Knot>& knots,
                     const std::vector<double>& output_time, EventResponse::Result& result) {
  States states(plan, knots.front().time + plan.delay);
  Outputs outputs(plan, static_cast<Eigen::Index>(output_time.size()), result);
  auto next = knots.begin();
  const auto arrival = [&] { return next->time + plan.delay; };
  for (const double t : output_time) {
    while (next != knots.end() && arrival() < t - rounding_at(t)) {
      states.advance(arrival());
      states.apply(*next++);
    }
    const bool on_knot = next != knots.end() && arrival() <= t + rounding_at(t);
    states.advance(t);
    outputs.add(states.entries(on_knot ? next->jump : 0));
    if (on_knot) states.apply(*next++);
  }
}

}  // namespace frac::detail
