// SPDX-License-Identifier: BSD-3-Clause
#include "event_run.hpp"

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

/// The states of the plan and the derivatives of the m-fold integral of the input, moved from instant to instant.
class States {
 public:
  States(const EventPlan& plan, double start)
      : reals_(plan.real_count),
        complexes_(plan.complex_count),
        level_(static_cast<Eigen::Index>(plan.integrators)),
        gaps_(plan),
        now_(start),
        state_(Eigen::ArrayXd::Zero(reals_ + 2 * complexes_)),
        input_(Eigen::ArrayXd::Zero(static_cast<Eigen::Index>(plan.channels))) {}

  [[nodiscard]] const Eigen::ArrayXd& state() const { return state_; }
  [[nodiscard]] const Eigen::ArrayXd& input() const { return input_; }

  void advance(double to) {
    if (to <= now_) return;
    const double length = to - now_;
    const Gap& gap = gaps_.of(length, rounding_at(now_ + length));
    now_ = to;
    if ((input_ == 0).all() && (state_ == 0).all()) return;
    move_states(gap);
    integrate_input(length);
  }

  void apply(const EventResponse::Knot& knot) {
    input_[level_] += knot.jump;
    if (level_ + 1 < input_.size()) input_[level_ + 1] += knot.slope;
  }

 private:
  void move_states(const Gap& gap) {
    state_.head(reals_) += gap.change_re.head(reals_) * state_.head(reals_);
    if (complexes_ > 0) {
      const auto change_re = gap.change_re.tail(complexes_);
      auto re = state_.segment(reals_, complexes_);
      auto im = state_.tail(complexes_);
      previous_ = re;
      re += change_re * previous_ - gap.change_im * im;
      im += gap.change_im * previous_ + change_re * im;
    }
    for (Eigen::Index i = 0; i < input_.size(); ++i) {
      if (input_[i] != 0) state_ += input_[i] * gap.drive.col(i);
    }
  }

  void integrate_input(double length) {
    for (Eigen::Index i = 0; i < input_.size(); ++i) {
      double factor = 1;
      for (Eigen::Index j = i + 1; j < input_.size(); ++j) {
        factor *= length / static_cast<double>(j - i);
        input_[i] += factor * input_[j];
      }
    }
  }

  Eigen::Index reals_, complexes_, level_;
  Gaps gaps_;
  double now_;
  Eigen::ArrayXd state_, previous_;
  Eigen::ArrayXd input_;
};

/// Turns states into outputs, a few hundred instants at a time.
class Outputs {
 public:
  Outputs(const EventPlan& plan, Eigen::Index rows, EventResponse::Result& result)
      : plan_(plan),
        result_(result),
        capacity_(std::min(rows, most_buffered)),
        states_(capacity_, plan.weight.rows()),
        inputs_(capacity_, static_cast<Eigen::Index>(plan.channels)),
        jumps_(capacity_) {
    result.value.resize(rows);
    result.gradient.resize(rows, plan.weight.cols() - 1);
  }

  /// @param jump  of the input at this instant, which the states do not know of yet
  void add(const States& at, double jump) {
    states_.row(buffered_) = at.state().matrix();
    inputs_.row(buffered_) = at.input().matrix();
    jumps_[buffered_] = jump;
    if (++buffered_ == capacity_) flush();
  }

  void flush() {
    if (buffered_ == 0) return;
    const auto x = states_.topRows(buffered_);
    const auto v = inputs_.topRows(buffered_);
    const auto jump = jumps_.head(buffered_);
    const Eigen::Index sensitivities = plan_.weight.cols() - 1;
    auto value = result_.value.segment(written_, buffered_);
    auto gradient = result_.gradient.middleRows(written_, buffered_);
    value.noalias() = x * plan_.weight.col(0);
    value.noalias() += v * plan_.constant.col(0);
    value += plan_.direct * jump;
    gradient.noalias() = x * plan_.weight.rightCols(sensitivities);
    gradient.noalias() += v * plan_.constant.rightCols(sensitivities);
    gradient.noalias() += jump * plan_.direct_by;
    if (!plan_.delay_slope.empty()) subtract_motion(gradient);
    written_ += buffered_;
    buffered_ = 0;
  }

 private:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  static constexpr Eigen::Index most_buffered = 512;

  /// A longer dead time moves the output back.  d/dt of each state is rate (state + what it takes).
  void subtract_motion(Eigen::Ref<Eigen::MatrixXd> gradient) const {
    const auto v = inputs_.topRows(buffered_);
    const auto level = static_cast<Eigen::Index>(plan_.integrators);
    Eigen::VectorXd motion = states_.topRows(buffered_) * plan_.motion;
    for (Eigen::Index k = 0; k < plan_.real_count + plan_.complex_count; ++k) {
      motion += plan_.motion[k] * v.col(plan_.is_direct[static_cast<std::size_t>(k)] ? level : 0);
    }
    for (Eigen::Index j = 0; j + 1 < v.cols(); ++j) motion += plan_.constant(j, 0) * v.col(j + 1);
    for (Eigen::Index p = 0; p < gradient.cols(); ++p) {
      gradient.col(p) -= plan_.delay_slope[static_cast<std::size_t>(p)] * motion;
    }
  }

  const EventPlan& plan_;
  EventResponse::Result& result_;
  Eigen::Index capacity_;
  Eigen::Index written_ = 0, buffered_ = 0;
  RowMajor states_;
  Eigen::MatrixXd inputs_;
  Eigen::VectorXd jumps_;
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
    outputs.add(states, on_knot ? next->jump : 0);
    if (on_knot) states.apply(*next++);
  }
  outputs.flush();
}

}  // namespace frac::detail
