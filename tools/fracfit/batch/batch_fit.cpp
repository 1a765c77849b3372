// SPDX-License-Identifier: BSD-3-Clause
#include "batch/batch_fit.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "frac/structure.hpp"
#include "io/data_error.hpp"
#include "io/fingerprint.hpp"
#include "io/input_text.hpp"
#include "io/number.hpp"
#include "output/fit_statistics.hpp"
#include "output/parameter_output.hpp"

namespace fracfit {
namespace {

constexpr const char* parameter_suffixes[] = {"", "_standard_error", "_ci95_lower", "_ci95_upper", "_state"};
constexpr const char* limit_suffixes[] = {"_lower_limit", "_upper_limit"};

std::vector<std::string> parameter_names(const BatchTask& task) {
  std::vector<std::string> names;
  for (const auto& model : task.models)
    for (const frac::Structure structure(model.formula); const auto& name : structure.parameter_names())
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

// Cells of a row by column; those not set stay empty.
class RowBuilder {
 public:
  explicit RowBuilder(const std::vector<std::string>& columns) {
    for (const auto& column : columns) row_.push_back({column, std::nullopt, std::nullopt});
  }
  void set(const std::string& column, double value) { cell(column).number = value; }
  void set(const std::string& column, std::size_t value) { cell(column).number = static_cast<double>(value); }
  void set(const std::string& column, std::string_view text) { cell(column).text = std::string(text); }
  [[nodiscard]] BatchRow row() && { return std::move(row_); }

 private:
  BatchCell& cell(const std::string& column) {
    return *std::find_if(row_.begin(), row_.end(), [&](const BatchCell& each) { return each.column == column; });
  }
  BatchRow row_;
};

const char* state_of(const frac::ParameterEstimate& parameter) {
  if (parameter.fixed) return "fixed";
  if (parameter.at_bound) return "at-bound";
  return parameter.identified ? "identified" : "not-identified";
}

// Outliers are those left out and those whose residuals stand out of the fit's.
void set_fit(RowBuilder& row, const frac::FitResult& result, std::size_t left_out, const std::string& remark) {
  row.set("status", frac::to_string(result.termination));
  row.set("model", std::string_view(result.model));
  row.set("cost", result.cost);
  row.set("rms", result.rms);
  row.set("aicc", result.aicc);
  row.set("bic", result.bic);
  row.set("outliers", left_out + result.outliers.size());
  row.set("left_out", left_out);
  row.set("message", std::string_view(with_advice(result.message, result.advice) + remark));
  for (const auto& parameter : result.parameters) {
    row.set(parameter.name, parameter.value);
    row.set(parameter.name + "_standard_error", parameter.standard_error);
    row.set(parameter.name + "_ci95_lower", parameter.ci95_lower);
    row.set(parameter.name + "_ci95_upper", parameter.ci95_upper);
    row.set(parameter.name + "_state", std::string_view(state_of(parameter)));
    row.set(parameter.name + "_lower_limit", parameter.lower_limit);
    row.set(parameter.name + "_upper_limit", parameter.upper_limit);
  }
}

void set_data(RowBuilder& row, const BatchTask& task, const io::FrequencyResponseFile& file) {
  for (const auto& variable : task.variables) {
    const auto text = io::find_value(file.metadata, variable);
    if (const auto value = text ? io::parse_number(*text) : std::nullopt) row.set(variable, *value);
  }
  row.set(std::string(fingerprint_column), std::string_view(file.fingerprint));
  row.set("points", file.data.size());
  row.set("omega_lower", file.data.omega().front());
  row.set("omega_upper", file.data.omega().back());
}

void say_nothing(const std::string&) {}

io::FrequencyResponseFile data_of(const BatchTask& task, const BatchCurve& curve) {
  return read_curve(task.request, curve, say_nothing);
}

FitRequest request_for(const BatchTask& task, const io::FrequencyResponseFile& file) {
  FitRequest request = task.request;
  request.component = frac::fitted_component(file.data, request.component);
  request.without_noise = io::is_computed(file.metadata);
  if (!task.weight_is_told && io::has_measured_sigma(file)) request.weight = frac::to_string(frac::Weight::given);
  return request;
}

// What of the request the curve decided.
std::string remark_on(const FitRequest& request, const BatchTask& task) {
  std::string remark;
  if (request.component != task.request.component) remark = " (" + std::string(frac::imaginary_part_alone) + ")";
  if (request.weight != task.request.weight) remark += " (" + std::string(weighed_by_measured_sigma) + ")";
  return remark;
}

BlockStarts::Answer answer_of(const BatchTask& task, const FitRequest& request, const frac::FrequencyResponseData& data,
                              const BlockStarts::Answer* similar) {
  frac::ModelRequest asked{task.models.front()};
  if (similar != nullptr) asked.similar = similar->fit.result;
  auto points = screened(request, data, say_nothing);
  auto fit = frac::fit(points, asked, fit_options(request));
  return {std::move(fit), std::move(points)};
}

void set_result(RowBuilder& row, const BatchTask& task, const io::FrequencyResponseFile& file, std::size_t index,
                BlockStarts& starts) {
  const FitRequest request = request_for(task, file);
  const std::string remark = remark_on(request, task);
  if (!task.ranked) {
    const BlockStarts::Answer* const first = starts[index];
    const auto [fit, points] =
        first != nullptr && BlockStarts::is_first(index) ? *first : answer_of(task, request, file.data, first);
    set_fit(row, fit.result, points.left_out().size(), remark);
    const auto statistics = fit_statistics(points.kept(), fit.options_from(fit_options(request)), fit.result, {}, 1);
    row.set("lag_one_correlation", statistics.whiteness.lag_one_correlation);
    row.set("whiteness_p_value", statistics.whiteness.p_value);
    return;
  }
  auto points = screened(request, file.data, say_nothing);
  // Files share the cores, so each works on one.
  const auto result = frac::identify(points, task.models, {}, fit_options(request), 1);
  set_fit(row, result.ranking.at(result.chosen).fit, points.left_out().size(), remark);
  row.set("chosen", std::string_view(result.ranking.at(result.chosen).name));
  row.set("verdict", frac::to_string(result.verdict));
  row.set("evidence", result.evidence);
}

}  // namespace

std::vector<std::string> batch_columns(const BatchTask& task) {
  std::vector<std::string> columns{"file", "status"};
  columns.insert(columns.end(), task.variables.begin(), task.variables.end());
  for (const char* name : {"points", "omega_lower", "omega_upper"}) columns.emplace_back(name);
  if (task.ranked)
    for (const char* name : {"chosen", "verdict", "evidence"}) columns.emplace_back(name);
  for (const char* name : {"model", "cost", "rms", "aicc", "bic", "outliers"}) columns.emplace_back(name);
  if (!task.ranked)
    for (const char* name : {"lag_one_correlation", "whiteness_p_value"}) columns.emplace_back(name);
  for (const auto& name : parameter_names(task))
    for (const char* suffix : parameter_suffixes) columns.push_back(name + suffix);
  columns.emplace_back("message");
  columns.emplace_back("left_out");
  columns.emplace_back(fingerprint_column);
  // Behind all others, whose places scripts count on.
  for (const auto& name : parameter_names(task))
    for (const char* suffix : limit_suffixes) columns.push_back(name + suffix);
  std::set<std::string> seen;
  for (const auto& column : columns)
    if (!seen.insert(column).second)
      throw std::invalid_argument("a batch would have two columns " + io::quoted(column) +
                                  "; give the parameter another name in the formula");
  return columns;
}

io::FrequencyResponseFile read_curve(FitRequest request, const BatchCurve& curve,
                                     const std::function<void(const std::string&)>& note) {
  request.data = curve.file;
  request.curve = curve.label;
  return curve.measurement ? read_data(request, *curve.measurement, note) : read_data(request, note);
}

std::vector<BatchCurve> curves_of(const std::vector<std::string>& files, const FitRequest& request) {
  std::vector<BatchCurve> curves;
  for (const auto& file : files) {
    std::vector<std::string> labels;
    std::string fingerprint;
    std::shared_ptr<const io::Measurement> kept;
    try {
      fingerprint = io::Fingerprint(*io::input_text(file)).text();
      io::Measurement measurement = io::read_measurement(file, request.how);
      labels = io::curve_labels(measurement, request.key_column);
      if (!labels.empty()) {
        io::prepare_curves(measurement, request.key_column);
        kept = std::make_shared<const io::Measurement>(std::move(measurement));
      }
    } catch (const io::DataError&) {  // its row will say it
    }
    if (labels.empty()) curves.push_back({file, file, "", fingerprint});
    for (const auto& label : labels) curves.push_back({file + "#" + label, file, label, fingerprint, kept});
  }
  return curves;
}

std::vector<std::string> variables_of(const BatchTask& task, const std::vector<BatchCurve>& curves,
                                      const std::string& wanted) {
  std::vector<std::string> names;
  const auto knows = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const auto& curve : curves) {
    try {
      for (const auto& [key, value] : data_of(task, curve).metadata)
        if (io::parse_number(value) && !knows(key)) names.push_back(key);
      for (const char* column : {"points", "omega_lower", "omega_upper"})
        if (!knows(column)) names.emplace_back(column);
    } catch (const io::DataError&) {  // its row will say it
    } catch (const std::invalid_argument&) {
    }
    if (knows(wanted)) break;
  }
  return names;
}

std::string fault_of_command(const BatchTask& task, const std::vector<BatchCurve>& curves) {
  std::string fault;
  for (const auto& curve : curves) {
    try {
      static_cast<void>(data_of(task, curve));
      return "";
    } catch (const io::DataError&) {  // its row will say it
    } catch (const std::invalid_argument& error) {
      if (fault.empty()) fault = error.what();
    }
  }
  return fault;
}

BlockStarts::BlockStarts(const BatchTask& task, const std::vector<BatchCurve>& curves)
    : task_(task), curves_(curves), blocks_(std::make_unique<Block[]>(curves.size() / block_size + 1)) {}

const BlockStarts::Answer* BlockStarts::operator[](std::size_t index) {
  if (task_.ranked) return nullptr;
  Block& block = blocks_[index / block_size];
  std::call_once(block.searched, [&] {
    try {
      const auto file = data_of(task_, curves_[index / block_size * block_size]);
      block.answer = answer_of(task_, request_for(task_, file), file.data, nullptr);
    } catch (const io::DataError&) {  // its row will say it
    } catch (const std::invalid_argument&) {
    }
  });
  return block.answer ? &*block.answer : nullptr;
}

BatchRow batch_row(const BatchTask& task, const std::vector<BatchCurve>& curves, std::size_t index,
                   BlockStarts& starts) {
  const BatchCurve& curve = curves[index];
  RowBuilder row(batch_columns(task));
  row.set("file", std::string_view(curve.name));
  try {
    const auto data = data_of(task, curve);
    set_data(row, task, data);
    set_result(row, task, data, index, starts);
  } catch (const io::DataError& error) {
    row.set("status", std::string_view("invalid-data"));
    row.set("message", std::string_view(error.what()));
  } catch (const std::invalid_argument& error) {
    row.set("status", std::string_view("not-fitted"));
    row.set("message", std::string_view(error.what()));
  } catch (const frac::NoCandidateFits& error) {
    row.set("status", std::string_view("not-fitted"));
    row.set("message", std::string_view(error.what()));
  }
  return std::move(row).row();
}

}  // namespace fracfit
