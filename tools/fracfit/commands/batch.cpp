// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "batch/batch_fit.hpp"
#include "batch/batch_power_law.hpp"
#include "batch/batch_reader.hpp"
#include "batch/batch_summary.hpp"
#include "commands/subcommand.hpp"
#include "frac/parallel_for.hpp"
#include "frac/structure.hpp"
#include "io/data_error.hpp"
#include "io/input_files.hpp"
#include "io/input_text.hpp"
#include "io/progress_bar.hpp"
#include "io/readable_file.hpp"
#include "io/result_stream.hpp"
#include "io/version.hpp"
#include "options/model_choice.hpp"
#include "output/aligned_table.hpp"

namespace fracfit {
namespace {

namespace fs = std::filesystem;

void check_names(const frac::NamedModel& model) {
  const auto names = frac::Structure(model.formula).parameter_names();
  for (const auto& constraint : model.constraints) {
    if (std::find(names.begin(), names.end(), constraint.name) == names.end())
      throw std::invalid_argument("parameter " + io::quoted(constraint.name) + " does not occur in " + model.formula);
    if (constraint.lower && constraint.upper && *constraint.lower > *constraint.upper)
      throw std::invalid_argument("--bound " + constraint.name + ": the lower limit lies above the upper one");
  }
}

/// Rows that an interrupted run of the same command has left in the output and that still hold: fits of files that have
/// not changed since.
/// @param part  indices of the curves that the output is of
std::map<std::string, std::string> finished_rows(const std::string& out, BatchFormat format,
                                                 const BatchManifest& manifest, const std::vector<BatchCurve>& curves,
                                                 const std::vector<std::size_t>& part) {
  std::map<std::string, std::string> rows;
  std::error_code ignored;
  if (!fs::is_regular_file(out, ignored) || fs::file_size(out, ignored) == 0) return rows;
  const io::Descriptor file = io::readable(out);
  BatchReader table(out, file.number());
  const BatchManifest& earlier = table.manifest();
  if (table.format() != format || earlier.version != manifest.version || earlier.command != manifest.command ||
      earlier.shard != manifest.shard || earlier.columns != manifest.columns)
    throw std::invalid_argument("--out " + out + " holds the results of another command: " + earlier.command +
                                (earlier.shard.empty() ? "" : " --shard " + earlier.shard) + " (fracfit " +
                                earlier.version + "); remove it or choose another file");
  std::map<std::string, std::string> fingerprints;
  for (const std::size_t i : part) fingerprints.emplace(curves[i].name, curves[i].fingerprint);
  table.check();
  table.each_row(table.first_row(), [&](const PlacedRow& placed) {
    const std::string curve = table.curve_of(placed), line(placed.line);
    const auto known = fingerprints.find(curve);
    if (known == fingerprints.end())
      throw std::invalid_argument("--out " + out + " holds a result for " + curve +
                                  ", which is not among the data; remove it or choose another file");
    const auto row = read_row(format, manifest.columns, line).value();
    const auto made_from = row.find(std::string(fingerprint_column));
    if (row.at("status") == "converged" && made_from != row.end() && made_from->second == known->second)
      rows.emplace(curve, line + "\n");
    return true;
  });
  return rows;
}

// A law needs a variable that the data, or a column of every row, know.
void check_variables(const std::vector<std::string>& laws, const BatchTask& task,
                     const std::vector<BatchCurve>& curves) {
  for (const auto& law : laws) {
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

// Prints the messages of the rows when no file could be read.
void complain_of_data(BatchFormat format, const BatchManifest& manifest, const std::vector<std::string>& lines) {
  const auto row = read_row(format, manifest.columns, lines.front()).value();
  complain(row.at("message") +
           (lines.size() > 1 ? "; nor can the other " + std::to_string(lines.size() - 1) + " curves be read" : ""));
}

std::string status_of(BatchFormat format, const BatchManifest& manifest, const std::string& line) {
  return read_row(format, manifest.columns, line).value().at("status");
}

// The remarks below the rows of a CSV, for people to read.
std::string laws_text(const std::string& remarks) {
  std::string text;
  for (const auto& line : io::whole_lines(remarks)) text += "\n" + paragraph(line.substr(2), 2);
  return text;
}

class Batch : public Command {
 public:
  Batch() : Command("batch", "Fits or identifies many curves, one row each") {
    Options& o = options();
    o.texts("DATA", data_, "Frequency responses as tables or as instruments write them, or folders of them",
            "FILE|FOLDER")
        .required()
        .names_input()
        .unsaid();
    o.text("--model", model_, "or a preset; letters other than s are parameters").suggest(preset_names());
    o.text("--models", models_);
    o.exactly_one({"--model", "--models"}, "the structure, which is fitted, or several, which are ranked");
    add_file_options(o, request_.how);
    add_residual_options(o, request_);
    add_points_and_seed(o, request_);
    add_outliers(o, request_);
    add_parameter_options(o, parameters_);
    for (const char* name : {"--fix", "--bound", "--start"}) o[name].not_with({"--models"});
    o.text("--by", request_.key_column,
           "Column whose value tells apart the curves that follow each other in one file, e.g. force_n", "COLUMN");
    o.texts("--power-law", laws_,
            "Parameter as a power of an entry of the file headers, of the --by column, or of the labels of columns "
            "(curve), e.g. a:force_n; repeatable",
            "PARAMETER:VARIABLE")
        .not_with({"--models"}, "as parameters of different structures form no law");
    add_shard("curves");
    add_progress();
    add_common({"csv", "jsonl", "table"});
    set_footer(
        "Several curves in one file: columns re_<label>,im_<label> (or magnitude_<label>,phase_deg_<label>) for each, "
        "or\n"
        "rows told apart by the column --by names.  Their rows are named FILE#LABEL.\n"
        "With --out each row reaches the file as soon as it is finished; the same command again does what is left "
        "over\n"
        "from an interrupted run, and again what failed or whose file has changed since.\n"
        "Examples:\n"
        "  fracfit batch sweeps --model power-law --where 'omega<4' --power-law K:force_n --out fits.csv\n"
        "  fracfit batch sweeps --models power-law,lag,gain --shard 2/4 --out part2.csv\n"
        "  fracfit batch all.csv --by force_n --model power-law --power-law K:force_n\n"
        "  fracfit merge part1.csv part2.csv part3.csv part4.csv --out all.csv");
  }

 private:
  [[nodiscard]] std::string format() const override {
    return !options()["--format"].is_given() && out().ends_with(".jsonl") ? "jsonl" : Command::format();
  }
  // A table for people is made from CSV.
  [[nodiscard]] BatchFormat row_format() const { return format() == "jsonl" ? BatchFormat::jsonl : BatchFormat::csv; }

  void check() override {
    for (const auto& text : request_.where) static_cast<void>(io::PointFilter(text));
    const bool ranked = model_.empty();
    static_cast<void>(fit_options(request_));
    task_ = {request_, {}, {"force_n", "clearance_m", "restitution"}, ranked, options()["--weight"].is_given()};
    if (ranked) {
      task_.models = chosen_models(models_);
    } else {
      task_.models = {chosen_model(model_)};
      task_.models.front().constraints = constraints_of(task_.models.front(), parameters_);
    }
    const auto has = [](const std::vector<std::string>& list, const std::string& name) {
      return std::find(list.begin(), list.end(), name) != list.end();
    };
    const auto& key = request_.key_column;
    if (!key.empty() && !has(task_.variables, key)) task_.variables.push_back(key);
    for (const auto& model : task_.models) check_names(model);
    for (const auto& law : laws_) {
      const auto request = power_law_request(law);
      const std::string& formula = task_.models.front().formula;
      if (!has(frac::Structure(formula).parameter_names(), request.parameter))
        throw std::invalid_argument("--power-law " + io::quoted(law) + ": " + io::quoted(request.parameter) +
                                    " is no parameter of " + formula);
      if (!has(batch_columns(task_), request.variable)) task_.variables.push_back(request.variable);
    }
  }

  // The curves of all files, of which no two have one name.
  [[nodiscard]] std::vector<BatchCurve> curves_in_order(bool to_file) const {
    std::vector<BatchCurve> curves = curves_of(io::input_files(data_, to_file ? out() : ""), request_);
    std::set<std::string> names;
    for (const auto& curve : curves)
      if (!names.insert(curve.name).second)
        throw std::invalid_argument("two curves have the name " + io::quoted(curve.name) +
                                    "; rename a file or a column");
    return curves;
  }

  // A line for each of some curves, taken from the stream where that has it.
  [[nodiscard]] std::vector<std::string> lines_of(const std::vector<BatchCurve>& curves,
                                                  const std::vector<std::size_t>& part, io::ResultStream* stream) {
    std::vector<std::string> lines(part.size());
    BlockStarts starts(task_, curves);
    frac::Progress progress;
    progress.total = part.size();
    const io::ProgressBar bar("batch", progress, progress_style());
    frac::parallel_for(part.size(), threads(), [&](std::size_t i) {
      const std::string& name = curves[part[i]].name;
      if (stream != nullptr && stream->contains(name)) {
        lines[i] = stream->text(name);
        lines[i].pop_back();
      } else {
        lines[i] = row_line(row_format(), batch_row(task_, curves, part[i], starts));
        if (stream != nullptr) stream->append(name, lines[i] + "\n");
      }
      ++progress.done;
    });
    return lines;
  }

  [[nodiscard]] int outcome(const BatchManifest& manifest, const std::vector<std::string>& lines,
                            const std::vector<std::string>& notes) const {
    std::map<std::string, std::size_t> without;  // a result, by their status
    for (const auto& line : lines) ++without[status_of(row_format(), manifest, line)];
    const std::size_t converged = without.contains("converged") ? without.extract("converged").mapped() : 0;
    if (!lines.empty() && without.contains("invalid-data") && without.at("invalid-data") == lines.size()) {
      complain_of_data(row_format(), manifest, lines);
      return invalid_data;
    }
    for (const auto& note : notes) say(note);
    std::string reasons;
    for (const auto& [status, count] : without)
      reasons += (reasons.empty() ? "" : ", ") + std::to_string(count) + " " + status;
    if (converged < lines.size())
      say(std::to_string(lines.size() - converged) + " of " + std::to_string(lines.size()) +
          " curves gave no result (" + reasons + "); see column status");
    return converged > 0 || lines.empty() ? usable_result : no_usable_result;
  }

  int run() override {
    const bool to_file = !out().empty() && out() != "-";
    const std::vector<BatchCurve> curves = curves_in_order(to_file);
    std::vector<std::string> inputs;
    for (const auto& curve : curves) inputs.push_back(curve.name);
    if (const auto fault = fault_of_command(task_, curves); !fault.empty()) throw std::invalid_argument(fault);
    check_variables(laws_, task_, curves);
    const std::string shard_text = options()["--shard"].is_given() ? io::text_of(shard()) : "";
    const BatchManifest manifest{std::string(io::version()), command_line(), shard_text, laws_, inputs,
                                 batch_columns(task_)};
    const auto header = header_text(row_format(), manifest);
    const std::vector<std::size_t> part = io::part_of(curves.size(), shard());
    std::optional<io::ResultStream> stream;
    if (to_file) stream.emplace(out(), header, finished_rows(out(), row_format(), manifest, curves, part));
    const std::vector<std::string> lines = lines_of(curves, part, stream ? &*stream : nullptr);

    std::string text = header;
    PowerLaws of_rows(row_format(), manifest);
    for (const auto& line : lines) {
      text += line + "\n";
      if (shard_text.empty()) of_rows.add(line);
    }
    const auto laws = shard_text.empty() ? of_rows.remarks() : PowerLawRemarks{};
    const std::string end = shard_text.empty() ? laws.text : shard_end(row_format(), io::Fingerprint(text));
    if (stream)
      stream->finish(text + end);
    else
      write(format() == "table" ? summary_of_rows(manifest, lines) + laws_text(laws.text) : text + end);
    return outcome(manifest, lines, laws.notes);
  }

  FitRequest request_;
  std::vector<std::string> data_, laws_;
  std::string model_, models_;
  ParameterOptions parameters_;
  BatchTask task_;
};

}  // namespace

std::unique_ptr<Command> make_batch() {
  return std::make_unique<Batch>();
}

}  // namespace fracfit
