// SPDX-License-Identifier: BSD-3-Clause
#include "report/data_figures.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>
#include <vector>

#include "frac/identification/statistics.hpp"
#include "frac/identification/uncertainty.hpp"
#include "report/html.hpp"
#include "report/measured.hpp"
#include "report/prose.hpp"
#include "report/ranking.hpp"
#include "report/sweep_curves.hpp"

namespace report {

namespace {

using Values = std::vector<double>;
using Response = std::vector<std::complex<double>>;

constexpr const char* data_colour = "#222222";
constexpr const char* second_colour = "#b03060";  // of the data of a second quantity in one panel
constexpr const char* band_colour = "#888888";

template <class Function>
Values each(const Response& response, Function function) {
  Values values;
  for (const auto& value : response) values.push_back(function(value));
  return values;
}

// A logarithmic axis has no place for other values.
double positive(double value) {
  return value > 0 && std::isfinite(value) ? value : std::nan("");
}

// Phase in degrees without jumps, on the turn nearest to `first`.
Values unwrapped_phase(const Response& values, double first) {
  Values phase;
  for (const auto& value : values) {
    const double before = phase.empty() ? first : phase.back();
    const double degrees = phase_degrees(value);
    phase.push_back(degrees + 360 * std::round((before - degrees) / 360));
  }
  return phase;
}

// The nearest to each power of ten, no further from it than a tenth of a decade.
std::vector<std::size_t> points_at_decades(const Values& frequency) {
  constexpr double near = 0.1;
  std::vector<std::size_t> points;
  for (double decade = std::round(std::log10(frequency.front())); decade <= std::log10(frequency.back()) + near;
       ++decade) {
    const auto away = [decade](double f) { return std::abs(std::log10(f) - decade); };
    const auto nearest =
        std::min_element(frequency.begin(), frequency.end(), [&](double a, double b) { return away(a) < away(b); });
    if (away(*nearest) <= near) points.push_back(static_cast<std::size_t>(nearest - frequency.begin()));
  }
  return points;
}

struct Modelled {
  DrawnFit drawn;
  Response response;
};

class Drawing {
 public:
  Drawing(std::string name, const frac::FrequencyResponseData& data, frac::Component component,
          const frac::IdentificationResult& result, Field field, const std::string& unit)
      : name_(std::move(name)),
        data_(data),
        imaginary_alone_(component == frac::Component::imaginary),
        chosen_(result.ranking.at(result.chosen)),
        field_(field),
        notation_(notation_of(field, unit, data.frequency_unit())),
        axis_(axis_values(notation_, data.omega())),
        model_(frac::fitted_response(chosen_.fit, frac::ExactRealisation{}, data.omega())),
        deviation_(frac::response_deviation(chosen_.fit, frac::ExactRealisation{}, data.omega())) {
    for (DrawnFit& drawn : drawn_fits(result)) {
      fits_.push_back({drawn, frac::fitted_response(drawn.ranked.fit, frac::ExactRealisation{}, data.omega())});
    }
    student_ = frac::student_t_95(static_cast<double>(chosen_.fit.residuals) -
                                  static_cast<double>(chosen_.fit.free_parameters));
    first_phase_ = unwrapped_phase(data.value(), 0).front();
  }

  [[nodiscard]] Figure response() const {
    Figure figure;
    figure.name = figure.link = name_;
    figure.caption = caption();
    if (imaginary_alone_) {
      figure.panels = {imaginary_part(), distance()};
      figure.panels.front().key = true;
      figure.panel_height = 230;
      return figure;
    }
    switch (field_) {
      case Field::impedance:
      case Field::admittance:
        figure.panels = {nyquist(), level(), phase(), distance()};
        figure.panels.front().tall = 2;
        figure.panels.back().wide = 2;
        figure.panels.back().key = true;
        name_the_rest(figure.panels.back());
        figure.columns = 2;
        figure.panel_height = 190;
        return figure;
      case Field::shear_modulus:
      case Field::tensile_modulus:
      case Field::permittivity:
        figure.panels = {parts(), loss_factor(), distance()};
        break;
      case Field::minus_inverse:
        figure.panels = {parts(), distance()};
        break;
      case Field::n:
      case Field::automatic:
      case Field::transfer_function:
        figure.panels = {level(), phase(), distance()};
        break;
    }
    figure.panels.front().key = true;
    figure.panel_height = 230;
    return figure;
  }

  // Shows data/model - 1 of the chosen structure.  To first order its real part is the relative error of the magnitude
  // and its imaginary part the error of the phase in rad.
  [[nodiscard]] Figure residuals() const {
    const Values zero(axis_.size(), 0.0);
    const auto panel = [&](const char* title, const char* axis, const Values& error, const Values& half_width) {
      Panel drawn = over_frequency(title, {axis, false});
      drawn.curves.push_back(band("95 % band of the fit", category_colour(0), zero, half_width));
      drawn.curves.push_back(make_curve("", category_colour(0), Mark::line, axis_, zero));
      drawn.curves.push_back(make_curve("data", data_colour, Mark::open_points, axis_, error));
      return drawn;
    };
    Figure figure;
    figure.name = name_ + "-residuals";
    figure.link = name_;
    figure.caption = prose("data", "residuals", {{"model", escape_html(chosen_.name)}});
    figure.panel_height = 220;
    if (imaginary_alone_) {
      figure.panels = {
          panel("Imaginary part", "data/model − 1 in %", error_of_imaginary(), relative_widths_of_imaginary())};
      figure.panels.back().key = true;
      return figure;
    }
    figure.columns = 2;
    figure.panels = {panel("Magnitude", "|data|/|model| − 1 in %", magnitude_error(), half_widths(100, true)),
                     panel("Phase", "data − model in 1/100 rad", phase_error(), half_widths(100, false))};
    figure.panels.back().key = true;
    return figure;
  }

  [[nodiscard]] Table values() const {
    Table table{name_ + "-curves", prose("data", "curves"), {}, {}, false};
    table.in_results = true;
    std::vector<Values> columns;
    const auto add = [&](const std::string& column, Values numbers) {
      table.columns.push_back({column, column});
      columns.push_back(std::move(numbers));
    };
    const auto add_response = [&](const std::string& before, const Response& response) {
      if (imaginary_alone_) {
        add(before + "im", imaginary_of(response));
        return;
      }
      add(before + "re", each(response, [](auto z) { return z.real(); }));
      add(before + "im", each(response, [](auto z) { return z.imag(); }));
      add(before + "magnitude", each(response, [](auto z) { return std::abs(z); }));
      add(before + "phase_deg", unwrapped_phase(response, first_phase_));
    };
    add(notation_.axis_name(), axis_);
    if (notation_.axis == frac::FrequencyUnit::hertz) add("omega_rad_s", data_.omega());
    add_response("", data_.value());
    for (std::size_t i = 0; i < fits_.size(); ++i) {
      const std::string before = "fit" + std::to_string(i + 1) + "_";
      add_response(before, fits_[i].response);
      add(before + "distance_percent", distance_of(fits_[i].response));
    }
    if (imaginary_alone_) {
      add("residual_imaginary_percent", error_of_imaginary());
    } else {
      add("residual_magnitude_percent", magnitude_error());
      add("residual_phase_centirad", phase_error());
    }
    for (std::size_t row = 0; row < axis_.size(); ++row) {
      auto& cells = table.rows.emplace_back();
      for (const Values& column : columns) cells.emplace_back(column[row]);
    }
    return table;
  }

 private:
  [[nodiscard]] std::string caption() const {
    if (imaginary_alone_) return prose("data", "imaginary-figure", {{"imaginary", notation_.imaginary}});
    switch (field_) {
      case Field::impedance:
      case Field::admittance:
        return prose("data", "nyquist-figure", {{"imaginary", notation_.imaginary}, {"real", notation_.real}});
      case Field::shear_modulus:
      case Field::tensile_modulus:
      case Field::permittivity:
        return prose("data", "parts-figure",
                     {{"imaginary", notation_.imaginary}, {"real", notation_.real}, {"symbol", notation_.symbol}});
      case Field::minus_inverse:
        return prose("data", "stiffness-figure", {{"imaginary", notation_.imaginary}, {"real", notation_.real}});
      case Field::n:
      case Field::automatic:
      case Field::transfer_function:
        break;
    }
    return prose("data", "figure");
  }

  [[nodiscard]] Panel over_frequency(const std::string& title, Axis vertical) const {
    Panel panel;
    panel.title = title;
    panel.x = {notation_.axis_label(), true};
    panel.y = std::move(vertical);
    return panel;
  }
  [[nodiscard]] std::string in_unit(const std::string& quantity) const {
    return enhanced_escape(with_unit(quantity, notation_.unit));
  }
  // The name of the chosen structure stands beside its curve, and may be as long as a line.
  [[nodiscard]] static std::string band_label() { return "95 % band of the chosen one"; }

  [[nodiscard]] Curve band(const std::string& label, const std::string& colour, const Values& middle,
                           const Values& half_width) const {
    Values lower, upper;
    for (std::size_t i = 0; i < axis_.size(); ++i) {
      lower.push_back(middle[i] - half_width[i]);
      upper.push_back(middle[i] + half_width[i]);
    }
    return make_band(label, colour, axis_, lower, upper);
  }

  // Half widths of the 95 % band of ln|model|, or of the phase in rad, times a factor.
  [[nodiscard]] Values half_widths(double factor, bool of_magnitude) const {
    Values widths;
    for (const auto& deviation : deviation_)
      widths.push_back(factor * student_ * (of_magnitude ? deviation.log_magnitude : deviation.phase));
    return widths;
  }

  // The fits and on top of them the data, as some quantity over the frequency.
  template <class Quantity>
  void add_curves(Panel& panel, Quantity quantity) const {
    for (const Modelled& fit : fits_)
      panel.curves.push_back(
          make_curve(fit.drawn.label, fit.drawn.colour, fit.drawn.mark, axis_, quantity(fit.response)));
    panel.curves.push_back(make_curve("data", data_colour, Mark::open_points, axis_, quantity(data_.value())));
  }

  [[nodiscard]] Panel nyquist() const {
    Panel panel;
    panel.title = "Nyquist";
    panel.equal_axes = true;
    panel.x = {in_unit(notation_.real), false};
    panel.y = {in_unit(notation_.imaginary), false};
    const auto curve = [&](const std::string& label, const std::string& colour, Mark mark, const Response& response) {
      return make_curve(label, colour, mark, each(response, [](auto z) { return z.real(); }),
                        each(response, [&](auto z) { return notation_.sign * z.imag(); }), axis_);
    };
    for (const Modelled& fit : fits_)
      panel.curves.push_back(curve(fit.drawn.label, fit.drawn.colour, fit.drawn.mark, fit.response));
    // Points where the frequency passes powers of ten, which the plane does not show otherwise.
    Values re, im, at;
    for (const std::size_t i : points_at_decades(axis_)) {
      re.push_back(data_.value()[i].real());
      im.push_back(notation_.sign * data_.value()[i].imag());
      at.push_back(axis_[i]);
    }
    panel.curves.push_back(make_curve("", data_colour, Mark::points, re, im, at));
    panel.curves.push_back(curve("data", data_colour, Mark::open_points, data_.value()));
    return panel;
  }

  [[nodiscard]] Panel level() const {
    if (field_ != Field::transfer_function) {
      Panel panel = over_frequency("Magnitude", {in_unit("|" + notation_.symbol + "|"), true});
      const auto magnitude = [](auto z) { return positive(std::abs(z)); };
      Values lower, upper;
      const Values width = half_widths(1, true);
      for (std::size_t i = 0; i < axis_.size(); ++i) {
        lower.push_back(positive(std::abs(model_[i]) * std::exp(-width[i])));
        upper.push_back(positive(std::abs(model_[i]) * std::exp(width[i])));
      }
      panel.curves.push_back(make_band(band_label(), band_colour, axis_, lower, upper));
      add_curves(panel, [&](const Response& response) { return each(response, magnitude); });
      return panel;
    }
    const std::string& unit = notation_.unit;
    Panel panel = over_frequency("Magnitude", {unit.empty() ? "dB" : "dB re 1 " + enhanced_escape(unit), false});
    const auto decibels = [](const Response& response) {
      return each(response, [](auto z) { return z == 0.0 ? std::nan("") : decibel(z); });
    };
    panel.curves.push_back(
        band(band_label(), band_colour, decibels(model_), half_widths(20 / std::numbers::ln10, true)));
    add_curves(panel, decibels);
    return panel;
  }

  [[nodiscard]] Panel phase() const {
    Panel panel = over_frequency("Phase", {.label = "degrees", .degrees = true});
    const auto degrees = [&](const Response& response) { return unwrapped_phase(response, first_phase_); };
    panel.curves.push_back(
        band(band_label(), band_colour, degrees(model_), half_widths(180 / std::numbers::pi, false)));
    add_curves(panel, degrees);
    return panel;
  }

  // Storage and loss in one panel.
  [[nodiscard]] Panel parts() const {
    Panel panel = over_frequency("Storage and loss", {in_unit(notation_.real + ", " + notation_.imaginary), true});
    const auto real = [](auto z) { return positive(z.real()); };
    const auto imaginary = [&](auto z) { return positive(notation_.sign * z.imag()); };
    const auto add_band = [&](const std::string& label, auto part, auto deviation_of) {
      Values lower, upper;
      for (std::size_t i = 0; i < axis_.size(); ++i) {
        const double width = student_ * deviation_of(deviation_[i]);
        lower.push_back(positive(part(model_[i]) - width));
        upper.push_back(positive(part(model_[i]) + width));
      }
      panel.curves.push_back(make_band(label, band_colour, axis_, lower, upper));
    };
    add_band(band_label(), real, [](const auto& deviation) { return deviation.real; });
    add_band("", imaginary, [](const auto& deviation) { return deviation.imaginary; });
    for (const Modelled& fit : fits_) {
      panel.curves.push_back(
          make_curve(fit.drawn.label, fit.drawn.colour, fit.drawn.mark, axis_, each(fit.response, real)));
      panel.curves.push_back(make_curve("", fit.drawn.colour, fit.drawn.mark, axis_, each(fit.response, imaginary)));
    }
    panel.curves.push_back(
        make_curve("data, " + notation_.real, data_colour, Mark::open_points, axis_, each(data_.value(), real)));
    panel.curves.push_back(make_curve("data, " + notation_.imaginary, second_colour, Mark::open_points, axis_,
                                      each(data_.value(), imaginary)));
    return panel;
  }

  [[nodiscard]] static Values imaginary_of(const Response& response) {
    return each(response, [](auto z) { return z.imag(); });
  }
  // The part that is drawn may have either sign.
  [[nodiscard]] Panel imaginary_part() const {
    Panel panel = over_frequency("Imaginary part", {in_unit(notation_.imaginary), false});
    const auto drawn = [&](const Response& response) {
      return each(response, [&](auto z) { return notation_.sign * z.imag(); });
    };
    panel.curves.push_back(band(band_label(), band_colour, drawn(model_), widths_of_imaginary()));
    add_curves(panel, drawn);
    return panel;
  }
  [[nodiscard]] Values widths_of_imaginary() const {
    Values widths;
    for (const auto& deviation : deviation_) widths.push_back(student_ * deviation.imaginary);
    return widths;
  }
  [[nodiscard]] Values relative_widths_of_imaginary() const {
    Values widths = widths_of_imaginary();
    for (std::size_t i = 0; i < axis_.size(); ++i) widths[i] *= 100 / std::abs(model_[i].imag());
    return widths;
  }
  [[nodiscard]] Values error_of_imaginary() const {
    Values errors;
    for (std::size_t i = 0; i < axis_.size(); ++i)
      errors.push_back(100 * (data_.value()[i].imag() / model_[i].imag() - 1));
    return errors;
  }

  [[nodiscard]] Panel loss_factor() const {
    Panel panel = over_frequency("Loss factor", {notation_.imaginary + "/" + notation_.real, true});
    add_curves(panel, [&](const Response& response) {
      return each(response, [&](auto z) { return positive(notation_.sign * z.imag() / z.real()); });
    });
    return panel;
  }

  [[nodiscard]] Values distance_of(const Response& model) const {
    Values distance;
    for (std::size_t i = 0; i < axis_.size(); ++i) {
      const std::complex<double> apart = model[i] - data_.value()[i];
      const double by = imaginary_alone_ ? std::abs(apart.imag()) : std::abs(apart);
      distance.push_back(positive(100 * by / std::abs(data_.value()[i])));
    }
    return distance;
  }

  [[nodiscard]] Panel distance() const {
    Panel panel = over_frequency("Distance of the fits from the data", {"|model − data| / |data| in %", true});
    for (const Modelled& fit : fits_)
      panel.curves.push_back(
          make_curve(fit.drawn.label, fit.drawn.colour, fit.drawn.mark, axis_, distance_of(fit.response)));
    return panel;
  }

  // The key of one panel stands for all: it names what only the others show.
  void name_the_rest(Panel& panel) const {
    panel.curves.push_back({"data", data_colour, Mark::open_points, {}});
    panel.curves.push_back({band_label(), band_colour, Mark::band, {}});
  }

  [[nodiscard]] Values magnitude_error() const {
    return error([](auto z) { return z.real(); });
  }
  [[nodiscard]] Values phase_error() const {
    return error([](auto z) { return z.imag(); });
  }
  template <class Part>
  [[nodiscard]] Values error(Part part) const {
    Values errors;
    for (std::size_t i = 0; i < axis_.size(); ++i) errors.push_back(part(100.0 * (data_.value()[i] / model_[i] - 1.0)));
    return errors;
  }

  std::string name_;
  const frac::FrequencyResponseData& data_;
  bool imaginary_alone_;
  const frac::RankedFit& chosen_;
  Field field_;
  Notation notation_;
  Values axis_;
  Response model_;  // of the chosen structure
  std::vector<frac::ResponseDeviation> deviation_;
  std::vector<Modelled> fits_;
  double student_ = 0, first_phase_ = 0;
};

}  // namespace

MeasuredPictures draw_measured(const std::string& name, const frac::FrequencyResponseData& data,
                               frac::Component component, const frac::IdentificationResult& result, Field field,
                               const std::string& unit) {
  const Drawing drawing(name, data, component, result, field, unit);
  MeasuredPictures pictures{drawing.response(), drawing.residuals(), drawing.values()};
  pictures.response.verdict = verdict_html(result);
  return pictures;
}

}  // namespace report
