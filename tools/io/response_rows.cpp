// SPDX-License-Identifier: BSD-3-Clause
#include "io/response_rows.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "io/bode_relation.hpp"
#include "io/fields.hpp"
#include "io/number.hpp"

namespace io {

bool RowReader::read(const TextTable::Row& row, Points& points) const {
  const double frequency = number(row, plan_.frequency);
  if (frequency == 0) return false;
  const double omega = frequency * to_radians_per_second_;
  if (!(frequency > 0) || !(omega > 0) || !std::isfinite(omega))
    fail(row, plan_.frequency, "a frequency must be > 0 and finite in rad/s");
  const bool is_cartesian = plan_.form == ValueForm::real_imaginary || plan_.form == ValueForm::real_tangent ||
                            plan_.form == ValueForm::imaginary_alone;
  const std::complex<double> value = is_cartesian ? cartesian(row) : polar(row);
  points.omega.push_back(omega);
  points.value.push_back(value);
  if (!plan_.spread) return true;
  const double spread = number(row, *plan_.spread);
  const double sigma = plan_.spread_is_weight ? 1 / std::sqrt(spread) : spread;
  if (!(spread > 0) || !(sigma > 0) || !std::isfinite(sigma))
    fail(row, *plan_.spread,
         plan_.spread_is_weight ? "a weight must be > 0; leave points out with --where"
                                : "a standard deviation must be > 0");
  // A phase alone has |value| = 1, so sigma becomes an angle in rad.
  points.sigma.push_back(plan_.form == ValueForm::phase_alone ? sigma * std::abs(to_radians_) : sigma);
  return true;
}

bool RowReader::has_no_value(const TextTable::Row& row) const {
  const auto is_nan = [&](std::size_t field) { return std::isnan(parse_number(row.fields[field]).value_or(0)); };
  return is_nan(plan_.first) && is_nan(plan_.second);
}

void RowReader::fail(const TextTable::Row& row, std::size_t field, const std::string& expected) const {
  throw DataError(
      table_.file(), row.line, row.column_of(field),
      "found " + quoted(row.fields[field]) + " in column " + quoted(table_.header()[field].text) + "; " + expected);
}

double RowReader::number(const TextTable::Row& row, std::size_t field) const {
  const auto text = row.fields[field];
  const auto value = parse_number(text);
  if (value && std::isfinite(*value)) return *value;
  if (value) fail(row, field, "expected a finite number");
  if (text.empty()) fail(row, field, "expected a number, the field is empty");
  const auto separators = std::count_if(text.begin(), text.end(), [](char c) { return c == ',' || c == '\''; });
  const bool has_point = text.find('.') != std::string_view::npos;
  if (separators > 1 || (separators == 1 && has_point))
    fail(row, field, "expected a number without separators between thousands");
  if (separators == 1 && text.find(',') != std::string_view::npos)
    fail(row, field, "expected a number with a decimal point, such as 1.5");
  fail(row, field, "expected a number");
}

std::complex<double> RowReader::cartesian(const TextTable::Row& row) const {
  if (plan_.form == ValueForm::real_tangent) return number(row, plan_.first) * by_tangent(row);
  const double imaginary = imaginary_sign_ * number(row, plan_.second);
  return {plan_.form == ValueForm::imaginary_alone ? 0 : number(row, plan_.first), imaginary};
}

std::complex<double> RowReader::by_tangent(const TextTable::Row& row) const {
  const double tangent = number(row, plan_.second);
  return {1, is_permittivity_ ? -tangent : tangent};
}

std::complex<double> RowReader::polar(const TextTable::Row& row) const {
  if (plan_.form == ValueForm::phase_alone) return std::polar(1.0, number(row, plan_.second) * to_radians_);
  const double given = number(row, plan_.first);
  const double magnitude = decibel_ ? std::pow(10, given / 20) : given;
  if (magnitude < 0) fail(row, plan_.first, "a magnitude must be >= 0");
  if (!std::isfinite(magnitude)) fail(row, plan_.first, "the magnitude is beyond the range of a double");
  if (plan_.form == ValueForm::magnitude_alone) return magnitude;
  if (plan_.form == ValueForm::magnitude_tangent) {
    const auto direction = by_tangent(row);
    return magnitude / std::abs(direction) * direction;
  }
  return std::polar(magnitude, number(row, plan_.second) * to_radians_);
}

SignsOfPhase::SignsOfPhase(const TextTable& table, const ColumnPlan& plan, const Planner& planner)
    : table_(table), plan_(plan) {
  const auto is_impedance = [&](std::size_t column) {
    return planner.meaning(column).symbol.empty() || planner.meaning(column).symbol == "z";
  };
  const std::string& symbol = planner.meaning(plan.first).symbol;
  is_one_port_ = symbol == "z" || symbol == "y";
  if (plan.form != ValueForm::real_imaginary || !is_impedance(plan.first)) return;
  for (std::size_t i = 0; i < table.header().size(); ++i) {
    const ColumnMeaning& meaning = planner.meaning(i);
    if (meaning.quantity != Quantity::phase || !is_impedance(i)) continue;
    phase_ = phase_ ? table.header().size() : i;  // of two it is open which is meant
    to_radians_ = meaning.problem.empty() ? meaning.factor : 0;
  }
  if (phase_ == table.header().size()) phase_.reset();
}

void SignsOfPhase::see(const TextTable::Row& row, std::complex<double> value) {
  if (!phase_) return;
  const double phase = parse_number(row.fields[*phase_]).value_or(0);
  if (to_radians_ == 0 && std::abs(phase) > 180) return;
  const double direction = to_radians_ == 0 ? phase : std::sin(phase * to_radians_);
  // Phases are written to a degree or better, so that an angle of a degree and less may have either sign.
  const double least = 0.02;
  if (std::abs(direction) < least || std::abs(value.imag()) < least * std::abs(value)) return;
  ++((direction > 0) == (value.imag() > 0) ? same_ : opposite_);
}

void SignsOfPhase::settle(Points& points, std::vector<std::string>& notes) const {
  if (plan_.form != ValueForm::real_imaginary) return;
  const bool is_opposite = same_ == 0 && opposite_ > 0;
  const bool consumes = is_one_port_ && std::all_of(points.value.begin(), points.value.end(),
                                                    [](std::complex<double> value) { return value.real() > 0; });
  if (!is_opposite && !consumes) return;
  const auto departure = departure_from_bode(points.omega, points.value);
  const auto& imaginary = table_.header()[plan_.second];
  if (departure && *departure > opposes_bode) {
    for (auto& value : points.value) value = std::conj(value);
    notes.push_back(
        "column " + quoted(imaginary.text) +
        " is read with the other sign, as the slope of the magnitude demands (Bode's relation); --columns " +
        "takes it as it stands");
    return;
  }
  if (!is_opposite || (departure && *departure < agrees_with_bode)) return;
  throw DataError(table_.file(), imaginary.line, imaginary.column,
                  "column " + quoted(imaginary.text) + " has the other sign than column " +
                      quoted(table_.header()[*phase_].text) +
                      " wherever that tells one; expected --columns with im=" + std::to_string(plan_.second + 1) +
                      " or -im=" + std::to_string(plan_.second + 1) + ", whichever it is");
}

bool keeps(const std::vector<PointFilter>& where, double omega, std::complex<double> value) {
  return std::all_of(where.begin(), where.end(), [&](const PointFilter& filter) { return filter(omega, value); });
}

namespace {

template <typename T>
std::vector<T> permuted(const std::vector<T>& values, const std::vector<std::size_t>& order) {
  std::vector<T> result;
  result.reserve(order.size());
  for (const auto index : order) result.push_back(values[index]);
  return result;
}

}  // namespace

void sort_by_frequency(Points& points, std::vector<std::string>& notes) {
  if (std::is_sorted(points.omega.begin(), points.omega.end())) return;
  std::vector<std::size_t> order(points.omega.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return points.omega[a] < points.omega[b]; });
  points.omega = permuted(points.omega, order);
  points.value = permuted(points.value, order);
  if (!points.sigma.empty()) points.sigma = permuted(points.sigma, order);
  notes.emplace_back("rows were not in rising frequency and have been sorted");
}

void leave_out_copies(Points& points, std::vector<std::string>& notes) {
  std::vector<std::size_t> originals;
  for (std::size_t i = 0; i < points.omega.size(); ++i) {
    if (i == 0 || points.omega[i] != points.omega[i - 1]) {
      originals.push_back(i);
    } else if (points.value[i] != points.value[i - 1] ||
               (!points.sigma.empty() && points.sigma[i] != points.sigma[i - 1])) {
      return;
    }
  }
  const std::size_t copies = points.omega.size() - originals.size();
  if (copies == 0) return;
  points.omega = permuted(points.omega, originals);
  points.value = permuted(points.value, originals);
  if (!points.sigma.empty()) points.sigma = permuted(points.sigma, originals);
  notes.push_back(std::to_string(copies) +
                  (copies == 1 ? " row is a copy of another and is" : " rows are copies of others and are") +
                  " left out: no repeat of a frequency differs");
}

}  // namespace io
