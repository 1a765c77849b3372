// SPDX-License-Identifier: BSD-3-Clause
#include "response_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "frac/cancellation.hpp"
#include "frac/parallel_for.hpp"
#include "steady_state/steady_state.hpp"
#include "steady_state/two_impact_orbit.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;

constexpr double log_gamma_step = 0.05;
// Chatter is smooth in gamma: every few steps are enough.
constexpr int chatter_stride = 4;
// The phasor of chatter grows like (1 - restitution)^(-1/3): linear interpolation errs by 0.2 % up to 0.8, by 1 %
// above.
constexpr std::array<double, 21> restitutions = {0,    0.05, 0.1,  0.15, 0.2,  0.25, 0.3,  0.35, 0.4,  0.45, 0.5,
                                                 0.55, 0.6,  0.65, 0.7,  0.75, 0.8,  0.85, 0.9,  0.94, 0.97};
// Between the orbits of two impacts and chatter the mean over chaotic and subharmonic motions is known to some percent
// at best.
constexpr int irregular_stride = 5;
constexpr double rough_mean = 0.03;

double gamma_of(int i) {
  return std::exp(lowest_log_gamma + log_gamma_step * i);
}

ResponseRow make_row(double restitution) {
  const int count = static_cast<int>(std::lround((highest_log_gamma - lowest_log_gamma) / log_gamma_step)) + 1;
  const double loss = restitution > 0 ? two_impact_loss(restitution).gamma : symmetry_loss(restitution).gamma;
  ResponseRow row{restitution, loss, std::exp(highest_log_gamma),
                  std::vector<std::optional<Complex>>(static_cast<std::size_t>(count))};
  for (int i = 0; i < count && gamma_of(i) <= loss; ++i) {
    frac::throw_if_cancelled();
    if (const auto response = two_impact_response(gamma_of(i), restitution)) {
      row.h[static_cast<std::size_t>(i)] = response->h;
    }
  }
  int last = count - 1;
  std::optional<Complex> last_h;
  for (int i = count - 1; i >= 0; i -= chatter_stride) {
    frac::throw_if_cancelled();
    const auto h = sticking_h(gamma_of(i), restitution);
    if (!h || gamma_of(i) <= loss) break;
    row.h[static_cast<std::size_t>(i)] = h;
    for (int k = i + 1; last_h && k < last; ++k) {
      const double share = static_cast<double>(k - i) / (last - i);
      row.h[static_cast<std::size_t>(k)] = (1 - share) * *h + share * *last_h;
    }
    last = i;
    last_h = h;
    row.chatter_onset = gamma_of(i);
  }
  return row;
}

// Fills what a row leaves open between its two motions, by averages from contact at rest.  They serve to rank starting
// points, to which the mean of a chaotic transient is as good as that of the orbit it ends on.
void fill_irregular(ResponseRow& row) {
  const auto first = static_cast<int>(std::floor((std::log(row.loss) - lowest_log_gamma) / log_gamma_step));
  std::optional<Complex> before;
  int place = first;
  for (int i = std::max(first, 0); i < static_cast<int>(row.h.size()); i += irregular_stride) {
    frac::throw_if_cancelled();
    const double gamma = gamma_of(i);
    const auto steady = find_steady_state(GapMotion(gamma, row.restitution), contact_at_rest_state(), 1e-6,
                                          {rough_mean, -gamma, Transients::ignored});
    const Complex here = steady.harmonics.u1_plus_gamma / gamma;
    for (int k = place; before && k <= i; ++k) {
      auto& entry = row.h[static_cast<std::size_t>(k)];
      const double share = static_cast<double>(k - place) / (i - place);
      if (!entry) entry = (1 - share) * *before + share * here;
    }
    before = here;
    place = i;
    if (gamma >= row.chatter_onset) break;
  }
}

// The row below a restitution in the table; the one beside it lies above, or the two are the last.
std::size_t row_below(double restitution) {
  const auto& rows = regular_table();
  std::size_t above = 1;
  while (above + 1 < rows.size() && rows[above].restitution < restitution) ++above;
  return above - 1;
}

}  // namespace

std::optional<Complex> ResponseRow::at(double log_gamma) const {
  const double place = (log_gamma - lowest_log_gamma) / log_gamma_step;
  if (!(place >= 0 && place < static_cast<double>(h.size() - 1))) return std::nullopt;
  const auto below = static_cast<std::size_t>(place);
  if (!h[below] || !h[below + 1]) return std::nullopt;
  const double share = place - static_cast<double>(below);
  return (1 - share) * *h[below] + share * *h[below + 1];
}

const std::vector<ResponseRow>& regular_table() {
  static const std::vector<ResponseRow> rows = [] {
    std::vector<ResponseRow> made(restitutions.size());
    frac::parallel_for(made.size(), 0, [&](std::size_t i) { made[i] = make_row(restitutions[i]); });
    return made;
  }();
  return rows;
}

const std::vector<ResponseRow>& full_table() {
  static const std::vector<ResponseRow> rows = [] {
    std::vector<ResponseRow> filled = regular_table();
    frac::parallel_for(filled.size(), 0, [&](std::size_t i) { fill_irregular(filled[filled.size() - 1 - i]); });
    return filled;
  }();
  return rows;
}

std::optional<Complex> mean_h(double gamma, double restitution) {
  const std::size_t below = row_below(restitution);
  const ResponseRow& lower = full_table()[below];
  const ResponseRow& upper = full_table()[below + 1];
  const auto first = lower.at(std::log(gamma));
  const auto second = upper.at(std::log(gamma));
  if (!first || !second) return std::nullopt;
  const double share = std::min((restitution - lower.restitution) / (upper.restitution - lower.restitution), 1.0);
  return (1 - share) * *first + share * *second;
}

double chatter_onset(double restitution) {
  if (restitution > restitutions.back()) return std::numeric_limits<double>::infinity();
  // A power of 1 - restitution between two rows.
  const std::size_t below = row_below(restitution);
  const ResponseRow& lower = regular_table()[below];
  const ResponseRow& upper = regular_table()[below + 1];
  const double slope =
      std::log(upper.chatter_onset / lower.chatter_onset) / std::log((1 - lower.restitution) / (1 - upper.restitution));
  return lower.chatter_onset * std::pow((1 - lower.restitution) / (1 - restitution), slope);
}

std::optional<GapResponse> rough_sticking_response(double gamma, double restitution) {
  const std::size_t below = row_below(restitution);
  const ResponseRow& lower = regular_table()[below];
  const ResponseRow& upper = regular_table()[below + 1];
  const double log_gamma = std::log(gamma);
  if (restitution > upper.restitution || gamma < std::max(lower.chatter_onset, upper.chatter_onset))
    return std::nullopt;
  const double half = 0.5 * log_gamma_step;
  const auto interpolated = [&](double at) -> std::optional<std::array<Complex, 2>> {
    const auto first = lower.at(at);
    const auto second = upper.at(at);
    if (!first || !second) return std::nullopt;
    return std::array{*first, *second};
  };
  const double width = upper.restitution - lower.restitution;
  const double share = (restitution - lower.restitution) / width;
  const auto here = interpolated(log_gamma);
  const auto weaker = interpolated(log_gamma - half);
  const auto stronger = interpolated(log_gamma + half);
  if (!here || !weaker || !stronger) return std::nullopt;
  const auto mixed = [&](const std::array<Complex, 2>& h) { return (1 - share) * h[0] + share * h[1]; };
  return GapResponse{mixed(*here), (mixed(*stronger) - mixed(*weaker)) / log_gamma_step,
                     ((*here)[1] - (*here)[0]) / width, 0};
}

}  // namespace backlash::detail
