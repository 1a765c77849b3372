// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>

#include "aligned_table.hpp"
#include "batch_fit.hpp"
#include "batch_power_law.hpp"
#include "choice.hpp"
#include "exit_code.hpp"
#include "frac/parallel_for.hpp"
#include "frac/structure.hpp"
#include "io/data_error.hpp"
#include "io/input_files.hpp"
#include "io/point_filter.hpp"
#include "io/progress_bar.hpp"
#include "io/result_stream.hpp"
#include "io/sweep_file.hpp"
#include "model_choice.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

namespace fs = std::filesystem;

struct BatchArguments {
  CommonOptions common;
  FitRequest request;
  std::vector<std::string> data;
  std::string model, models, shard;
  ParameterOptions parameters;
  std::vector<std::string> laws;
};

void check_names(const frac::NamedModel& model) {
  const auto names = frac::Structure(model.formula).parameter_names();
  for (const auto& constraint : model.constraints) {
    if (std::find(names.begin(), names.end(), constraint.name) == names.end())
      throw std::invalid_argument("parameter " + io::quoted(constraint.name) + " does not occur in " + model.formula);
    if (constraint.lower && constraint.upper && *constraint.lower > *constraint.upper)
      throw std::invalid_argument("--bound " + constraint.name + ": the lower limit lies above the upper one");
  }
}

BatchTask task_of(const BatchArguments& given) {
  if (given.model.empty() == given.models.empty())
    throw std::invalid_argument("give either --model, which is fitted, or --models, which are ranked");
  BatchTask task{
      given.request, fit_options(given.request), {}, {"force_n", "clearance_m", "restitution"}, given.model.empty()};
  if (task.ranked) {
    const auto& options = given.parameters;
    if (!options.fix.empty() || !options.bound.empty() || !options.start.empty())
      throw std::invalid_argument("--fix, --bound and --start have no meaning with --models");
    if (!given.laws.empty())
      throw std::invalid_argument("--power-law needs --model: parameters of different structures form no law");
    task.models = chosen_models(given.models);
  } else {
    task.models = {chosen_model(given.model)};
    task.models.front().constraints = constraints_of(task.models.front(), given.parameters);
  }
  const auto& key = given.request.key_column;
  if (!key.empty() && std::find(task.variables.begin(), task.variables.end(), key) == task.variables.end())
    task.variables.push_back(key);
  for (const auto& text : given.request.where) static_cast<void>(io::PointFilter(text));
  for (const auto& model : task.models) check_names(model);
  for (const auto& law : given.laws) {
    const auto request = power_law_request(law);
    const auto names = frac::Structure(task.models.front().formula).parameter_names();
    if (std::find(names.begin(), names.end(), request.parameter) == names.end())
      throw std::invalid_argument("--power-law " + io::quoted(law) + ": " + io::quoted(request.parameter) +
                                  " is no parameter of " + task.models.front().formula);
    const auto columns = batch_columns(task);
    if (std::find(columns.begin(), columns.end(), request.variable) == columns.end())
      task.variables.push_back(request.variable);
  }
  return task;
}

std::string command_of(const BatchArguments& given, const BatchTask& task) {
  CommandLine command("batch");
  if (!task.ranked) command.option("--model", given.model);
  if (task.ranked) command.option("--models", given.models);
  append_to(command, given.request, task.options);
  for (const auto& text : given.parameters.bound) command.option("--bound", text);
  for (const auto& text : given.parameters.fix) command.option("--fix", text);
  for (const auto& text : given.parameters.start) command.option("--start", text);
  if (!given.request.key_column.empty()) command.option("--by", given.request.key_column);
  for (const auto& text : given.laws) command.option("--power-law", text);
  return command.text();
}

BatchFormat format_of(const BatchArguments& given) {
  if (given.common.format.empty()) return given.common.out.ends_with(".jsonl") ? BatchFormat::jsonl : BatchFormat::csv;
  return given.common.format == "jsonl" ? BatchFormat::jsonl : BatchFormat::csv;
}

// Rows that an interrupted run of the same command has left in the output and that still hold: fits of files that have
// not changed since.
std::map<std::string, std::string> finished_rows(const std::string& out, BatchFormat format,
                                                 const BatchManifest& manifest, const std::vector<std::string>& files,
                                                 const std::map<std::string, BatchCurve>& curves) {
  std::map<std::string, std::string> rows;
  std::error_code ignored;
  if (!fs::is_regular_file(out, ignored) || fs::file_size(out, ignored) == 0) return rows;
  const auto table = read_batch_table(out);
  if (table.format != format || table.manifest.version != manifest.version ||
      table.manifest.command != manifest.command || table.manifest.shard != manifest.shard ||
      table.manifest.columns != manifest.columns)
    throw std::invalid_argument("--out " + out + " holds the results of another command: " + table.manifest.command +
                                (table.manifest.shard.empty() ? "" : " --shard " + table.manifest.shard) +
                                " (fracfit " + table.manifest.version + "); remove it or choose another file");
  const std::set<std::string> known(files.begin(), files.end());
  for (const auto& [file, line] : table.rows) {
    if (!known.contains(file))
      throw std::invalid_argument("--out " + out + " holds a result for " + file +
                                  ", which is not among the data; remove it or choose another file");
    const auto row = read_row(format, manifest.columns, line).value();
    const auto made_from = row.find(std::string(fingerprint_column));
    if (row.at("status") == "converged" && made_from != row.end() && made_from->second == curves.at(file).fingerprint)
      rows.emplace(file, line);
  }
  return rows;
}

// A law needs a variable that the data, or a column of every row, know.
void check_variables(const BatchArguments& given, const BatchTask& task, const std::vector<BatchCurve>& curves) {
  for (const auto& law : given.laws) {
    const auto variable = power_law_request(law).variable;
    const auto columns = batch_columns(task);
    const bool of_headers = std::find(task.variables.begin(), task.variables.end(), variable) != task.variables.end();
    if (!of_headers && std::find(columns.begin(), columns.end(), variable) != columns.end()) continue;
    const auto known = variables_of(task, curves, variable);
    if (known.empty() || std::find(known.begin(), known.end(), variable) != known.end()) continue;
    std::vector<std::string> list = known;
    for (const auto& model : task.models)
      for (const frac::Structure structure(model.formula); const auto& name : structure.parameter_names())
        list.push_back(name);
    throw std::invalid_argument("--power-law " + io::quoted(law) + ": " + io::quoted(variable) +
                                " is no number in the header of any file and no column of the rows; known are " +
                                io::shortened_list(list));
  }
}

// The trouble with data of which none can be read, as the rows tell it.
void complain_of_data(BatchFormat format, const BatchManifest& manifest, const std::vector<std::string>& lines) {
  const auto row = read_row(format, manifest.columns, lines.front()).value();
  say({}, row.at("message") +
              (lines.size() > 1 ? "; nor can the other " + std::to_string(lines.size() - 1) + " curves be read" : ""));
}

std::string status_of(BatchFormat format, const BatchManifest& manifest, const std::string& line) {
  return read_row(format, manifest.columns, line).value().at("status");
}

int run_batch(const BatchArguments& given) {
  const auto task = task_of(given);
  const auto format = format_of(given);
  const bool to_file = !given.common.out.empty() && given.common.out != "-";
  const io::OutputFile out(given.common.out, given.data);
  std::vector<std::string> inputs;
  std::map<std::string, BatchCurve> curves;
  for (auto& curve :
       curves_of(io::input_files(given.data, to_file ? given.common.out : ""), given.request.key_column)) {
    inputs.push_back(curve.name);
    if (!curves.emplace(curve.name, curve).second)
      throw std::invalid_argument("two curves have the name " + io::quoted(curve.name) + "; rename a file or a column");
  }
  const auto files = io::part_of(inputs, shard_option(given.shard));
  std::vector<BatchCurve> in_order;
  for (const auto& name : inputs) in_order.push_back(curves.at(name));
  if (const auto fault = fault_of_command(task, in_order); !fault.empty()) throw std::invalid_argument(fault);
  check_variables(given, task, in_order);
  const BatchManifest manifest{std::string(io::version()), command_of(given, task), given.shard, given.laws, inputs,
                               batch_columns(task)};
  const auto header = header_text(format, manifest);

  std::unique_ptr<io::ResultStream> stream;
  if (to_file)
    stream = std::make_unique<io::ResultStream>(given.common.out, header,
                                                finished_rows(given.common.out, format, manifest, files, curves));
  std::vector<std::string> lines(files.size());
  frac::Progress progress;
  progress.total = files.size();
  {
    const io::ProgressBar bar("batch", progress, !given.common.quiet);
    frac::parallel_for(files.size(), given.common.threads, [&](std::size_t i) {
      if (stream && stream->contains(files[i])) {
        lines[i] = stream->line(files[i]);
      } else {
        lines[i] = row_line(format, batch_row(task, curves.at(files[i])));
        if (stream) stream->append(files[i], lines[i]);
      }
      ++progress.done;
    });
  }
  std::string text = header;
  for (const auto& line : lines) text += line + "\n";
  const auto laws = given.shard.empty() ? power_law_remarks(format, manifest, lines) : PowerLawRemarks{};
  text += given.shard.empty() ? laws.text : shard_end(format, text);
  if (stream) {
    stream->finish(text);
  } else {
    out.write(text);
  }
  std::size_t converged = 0, unreadable = 0;
  for (const auto& line : lines) {
    const auto status = status_of(format, manifest, line);
    converged += status == "converged" ? 1U : 0U;
    unreadable += status == "invalid-data" ? 1U : 0U;
  }
  if (!files.empty() && unreadable == files.size()) {
    complain_of_data(format, manifest, lines);
    return invalid_data;
  }
  for (const auto& note : laws.notes) say(given.common, note);
  if (converged < files.size())
    say(given.common, std::to_string(files.size() - converged) + " of " + std::to_string(files.size()) +
                          " curves gave no result; see column status");
  return converged > 0 || files.empty() ? usable_result : no_usable_result;
}

}  // namespace

void add_batch(CLI::App& program, Run& run) {
  const auto given = std::make_shared<BatchArguments>();
  auto* batch = program.add_subcommand("batch", "Fits or identifies many curves, one row each");
  batch->add_option("DATA", given->data, "Frequency responses, or folders of them (.csv, .tsv, .txt, .dat)")
      ->required()
      ->type_name("FILE|FOLDER");
  batch->add_option("--model", given->model, "Preset or formula to fit")
      ->type_name("MODEL")
      ->check(suggest(preset_names()));
  batch->add_option("--models", given->models, "Presets or formulas to rank, separated by commas")->type_name("LIST");
  add_residual_options(*batch, given->request);
  add_repeatable(*batch, "--fix", given->parameters.fix, "Hold a parameter at a value; repeatable", "NAME=VALUE");
  add_repeatable(*batch, "--bound", given->parameters.bound, "Limit a parameter; repeatable", "NAME=LOW:HIGH");
  add_repeatable(*batch, "--start", given->parameters.start, "Start a parameter at a value; repeatable", "NAME=VALUE");
  add_repeatable(*batch, "--power-law", given->laws,
                 "Parameter as a power of an entry of the file headers, of the --by column, or of the labels of "
                 "columns (curve), e.g. a:force_n; repeatable",
                 "PARAMETER:VARIABLE");
  batch
      ->add_option("--by", given->request.key_column,
                   "Column whose value tells apart the curves that follow each other in one file, e.g. force_n")
      ->type_name("COLUMN");
  batch->add_option("--shard", given->shard, "Work on every n-th curve only, from the i-th; join with fracfit merge")
      ->type_name("i/n");
  add_common_options(*batch, given->common, {"csv", "jsonl"});
  batch->footer(
      "Several curves in one file: columns re_<label>,im_<label> (or magnitude_<label>,phase_deg_<label>) for each, "
      "or\n"
      "rows told apart by the column --by names.  Their rows are named FILE#LABEL.\n"
      "With --out each row reaches the file as soon as it is finished; the same command again does what is left over\n"
      "from an interrupted run, and again what failed or whose file has changed since.\n"
      "Examples:\n"
      "  fracfit batch sweeps --model power-law --where 'omega<4' --power-law K:force_n --out fits.csv\n"
      "  fracfit batch sweeps --models power-law,lag,gain --shard 2/4 --out part2.csv\n"
      "  fracfit batch all.csv --by force_n --model power-law --power-law K:force_n\n"
      "  fracfit merge all.csv part1.csv part2.csv part3.csv part4.csv");
  batch->callback([given, &run] { run = [given] { return run_batch(*given); }; });
}

}  // namespace fracfit
