// SPDX-License-Identifier: BSD-3-Clause
#include "report/report.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <utility>
#include <variant>

#include "io/number.hpp"
#include "io/time_series_file.hpp"
#include "io/version.hpp"
#include "report/bands.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/results_json.hpp"
#include "report/sections.hpp"
#include "report/staged_folder.hpp"

#ifndef FRACFIT_BUILD_TYPE
#error "FRACFIT_BUILD_TYPE comes from the build system"
#endif

namespace report {

namespace {

using Clock = std::chrono::steady_clock;

// One chapter of the page: its name, whether it takes seconds, and what writes it.
struct Chapter {
  std::string name;
  bool takes_long;
  std::function<Section(const Work&)> write;
};

// Runs what a report consists of, tells the caller the name of each part as it begins and records how long it took.
class Stages {
 public:
  explicit Stages(const ReportOptions& options) : options_(options) {}

  // Data that chapters need in common, before them; the body has all threads.
  template <typename Body>
  auto run(const std::string& name, Body body) {
    begin(name);
    count(0, 0);
    const auto start = Clock::now();
    auto result = body();
    times_.push_back({name, seconds_since(start)});
    return result;
  }

  // Chapters need nothing of each other: as many at once as there are threads, those that take long first, so that
  // short ones fill what they leave; in the order given when all are written.
  // @param draw  draws the figures of one, and returns what went wrong
  std::vector<Section> write(const std::vector<Chapter>& chapters, Work work,
                             const std::function<std::string(const Section&)>& draw) {
    std::vector<std::size_t> order(chapters.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_partition(order.begin(), order.end(), [&](std::size_t k) { return chapters[k].takes_long; });
    const auto threads = static_cast<int>(threads_of(options_));
    work.threads = std::max(1, threads / static_cast<int>(std::max<std::size_t>(1, chapters.size())));
    work.progress = nullptr;
    count(0, chapters.size());
    std::vector<Section> sections(chapters.size());
    std::vector<StageTime> times(chapters.size());
    std::vector<std::string> troubles(chapters.size());
    frac::parallel_for(chapters.size(), threads, [&](std::size_t k) {
      const Chapter& chapter = chapters[order[k]];
      begin(chapter.name);
      const auto start = Clock::now();
      sections[order[k]] = chapter.write(work);
      troubles[order[k]] = draw(sections[order[k]]);
      times[order[k]] = {chapter.name, seconds_since(start)};
      if (options_.progress != nullptr) ++options_.progress->done;
    });
    times_.insert(times_.end(), times.begin(), times.end());
    for (const std::string& trouble : troubles) {
      if (trouble_.empty()) trouble_ = trouble;
    }
    return sections;
  }

  [[nodiscard]] const std::vector<StageTime>& times() const noexcept { return times_; }
  /// Why pictures are missing; empty where none is.
  [[nodiscard]] const std::string& trouble() const noexcept { return trouble_; }

  static std::size_t threads_of(const ReportOptions& options) {
    return options.threads > 0 ? static_cast<std::size_t>(options.threads)
                               : std::max<std::size_t>(1, std::thread::hardware_concurrency());
  }

 private:
  static double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  }
  void begin(const std::string& name) {
    const std::lock_guard lock(mutex_);
    if (options_.stage) options_.stage(name);
  }
  void count(std::size_t done, std::size_t total) {
    if (options_.progress == nullptr) return;
    options_.progress->done = done;
    options_.progress->total = total;
  }

  const ReportOptions& options_;
  std::mutex mutex_;
  std::vector<StageTime> times_;
  std::string trouble_;
};

// What a chapter finds, where no page before it says so.
void begin_with_findings(Section& section) {
  std::string text;
  for (const std::string& finding : section.findings) text += "<p>" + finding + "</p>\n";
  if (!text.empty()) section.blocks.insert(section.blocks.begin(), Html{text});
}

Section summary_section(const std::vector<Section>& sections) {
  Section section = open_section("summary");
  std::string list = "<ul>\n";
  for (const Section& other : sections) {
    for (const std::string& finding : other.findings) list += "<li>" + finding + "</li>\n";
  }
  section.add(Html{list + "</ul>"});
  return section;
}

Section provenance_section(const Provenance& provenance, const std::vector<Section>& sections) {
  Section section;
  section.id = "provenance";
  section.title = prose("provenance", "title");
  Table stages{"seconds",
               prose("provenance", "stages", {{"threads", std::to_string(provenance.threads)}}),
               {{"stage", "stage"}, {"seconds", "seconds", 3}}};
  for (const StageTime& stage : provenance.stages) stages.rows.push_back({stage.name, stage.seconds});
  std::string files = prose("provenance", "files") + "\n";
  for (const Section& other : sections) {
    for (const Block& block : other.blocks) {
      if (const Table* table = std::get_if<Table>(&block)) {
        files += prose("provenance", "table", {{"name", table->name}}) + "\n";
      } else if (const Figure* figure = std::get_if<Figure>(&block)) {
        files += prose("provenance", "figure", {{"name", figure->name}}) + "\n";
      }
    }
  }
  section.add(Html{prose("provenance", "made",
                         {{"version", escape_html(provenance.version)},
                          {"compiler", escape_html(provenance.compiler)},
                          {"build", escape_html(provenance.build_type)},
                          {"command", escape_html(provenance.command)}})});
  section.add(std::move(stages));
  section.add(Html{files + "</ul></details>"});
  return section;
}

std::vector<Section> scene_sections(const Work& work, Stages& stages,
                                    const std::function<std::string(const Section&)>& draw) {
  if (work.scene.contact) return stages.write({{"contacts that take time", true, compliant_section}}, work, draw);
  const Curves curves = stages.run("describing functions", [&] { return compute_curves(work); });
  const bool has_gap = work.scene.clearance > 0;
  const Bands bands = has_gap ? stages.run("smooth bands", [&] { return smooth_bands(work, curves); }) : Bands{};
  std::vector<Chapter> chapters;
  constexpr bool takes_long = true;
  const auto add = [&](bool applies, const std::string& name, std::function<Section(const Work&)> write,
                       bool is_long = false) {
    if (applies) chapters.push_back({name, is_long, std::move(write)});
  };
  const bool is_paper = work.scene.of_the_paper;
  add(true, "in one minute", [&](const Work& w) { return minute_section(w, bands); });
  add(true, "curves", [&](const Work& w) { return curves_section(w, curves); });
  add(has_gap, "loss factor", [&](const Work& w) { return loss_factor_section(w, curves); });
  add(has_gap, "local slope", [&](const Work& w) { return slope_section(w, bands); });
  add(
      has_gap, "economy", [&](const Work& w) { return economy_section(w, bands); }, takes_long);
  add(
      true, "jump laws", [&](const Work& w) { return jump_section(w, curves); }, takes_long);
  add(has_gap, "orbits", orbit_section);
  add(is_paper, "regime map", map_section, takes_long);
  add(has_gap, "limit cycles", limit_cycles_section, takes_long);
  add(is_paper, "approximations", [&](const Work& w) { return approximation_section(w, bands); });
  add(true, "speed against error", speed_section);
  add(true, "a fractional model", [](const Work&) { return model_section(); });
  add(
      true, "time responses", [](const Work&) { return response_speed_section(); }, takes_long);
  std::vector<Section> sections = stages.write(chapters, work, draw);
  for (Section& section : sections) begin_with_findings(section);
  add_sentences(sections.front(), work, bands, sections);
  return sections;
}

void write_tables(const StagedFolder& folder, const std::vector<Section>& sections, const Provenance& provenance) {
  Metadata metadata = {{"fracfit", provenance.version}, {"command", provenance.command}};
  metadata.insert(metadata.end(), provenance.inputs.begin(), provenance.inputs.end());
  for (const Section& section : sections) {
    for (const Block& block : section.blocks) {
      if (const Table* table = std::get_if<Table>(&block)) {
        folder.write("tables/" + table->name + ".csv", csv_text(*table, metadata));
      }
    }
  }
}

// Draws the figures of a chapter.  Returns nothing on success, else the first error.
std::string draw_figures(const StagedFolder& folder, const std::optional<std::filesystem::path>& gnuplot,
                         const Section& section) {
  std::vector<std::string> names;
  for (const Block& block : section.blocks) {
    const Figure* figure = std::get_if<Figure>(&block);
    if (figure == nullptr) continue;
    const std::string script = gnuplot_script(*figure);
    if (script.empty()) continue;
    folder.write("figures/" + figure->name + ".gp", script);
    names.push_back(figure->name);
  }
  if (!gnuplot) return names.empty() ? "" : gnuplot_missing();
  return draw(*gnuplot, folder.path() / "figures", names);
}

std::string list_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + io::format_number(value);
  return text;
}

std::string range_text(const std::vector<double>& values) {
  return io::format_number(values.front()) + " to " + io::format_number(values.back()) + " in " +
         std::to_string(values.size()) + " points";
}

Metadata inputs_of(const ReportOptions& options, const Scene& scene) {
  Metadata inputs;
  for (const auto& file : options.data) inputs.emplace_back("data_" + std::to_string(inputs.size() + 1), file.string());
  if (!inputs.empty()) return inputs;
  if (scene.contact)
    return {{"m1_kg", io::format_number(scene.mass1)},
            {"m2_kg", io::format_number(scene.mass2)},
            {"contact_stiffness_n_m", io::format_number(scene.contact->stiffness())},
            {"contact_damping_n_s_m", io::format_number(scene.contact->damping())},
            {"friction1_n", io::format_number(scene.friction.body1)},
            {"friction2_n", io::format_number(scene.friction.body2)},
            {"forces_n", list_text(scene.forces)},
            {"clearances_m", list_text(scene.clearances)},
            {"omega_rad_s", range_text(scene.omega_family)}};
  return {{"m1_kg", io::format_number(scene.mass1)},
          {"m2_kg", io::format_number(scene.mass2)},
          {"base_force_n", io::format_number(scene.force)},
          {"base_clearance_m", io::format_number(scene.clearance)},
          {"base_restitution", io::format_number(scene.restitution)},
          {"forces_n", list_text(scene.forces)},
          {"clearances_m", list_text(scene.clearances)},
          {"restitutions", list_text(scene.restitutions)},
          {"omega_nichols_rad_s", range_text(scene.omega_nichols)},
          {"omega_bode_rad_s", range_text(scene.omega_bode)},
          {"omega_families_rad_s", range_text(scene.omega_family)},
          {"jump_forces_n", list_text(scene.jump_forces)},
          {"jump_clearances_m", list_text(scene.jump_clearances)},
          {"jump_restitutions", list_text(scene.jump_restitutions)}};
}

#if defined(__clang__)
constexpr const char* compiler = "clang " __clang_version__;
#else
constexpr const char* compiler = "g++ " __VERSION__;
#endif

Provenance provenance_of(const ReportOptions& options, const Scene& scene) {
  return {std::string(io::version()),
          options.command,
          compiler,
          FRACFIT_BUILD_TYPE,
          static_cast<int>(Stages::threads_of(options)),
          {},
          inputs_of(options, scene)};
}

struct TimeRecord {
  frac::TimeResponseData data;
  std::vector<std::string> notes;
};
// One curve or one record of the data.
struct Data {
  std::string name;
  std::variant<io::FrequencyResponseFile, TimeRecord> content;
};

std::string scene_text(const io::Metadata& scene) {
  std::string text;
  for (const auto& [column, value] : scene) text += ", " + column + " " + value;
  return text;
}

// All that a file holds: one record over time, or one or several frequency responses.
void read_data(const std::filesystem::path& path, const ReportOptions& asked, std::vector<Data>& data) {
  const io::MeasurementOptions& how = asked.how;
  const std::string file = path.string();
  const std::string name = path.filename().string();
  if (io::holds_time_response(file, how)) {
    io::TimeSeries series = io::read_time_response(file);
    std::vector<std::string> notes = std::move(series.notes);
    data.push_back({name, TimeRecord{io::time_response_data(file, std::move(series)), std::move(notes)}});
    return;
  }
  const io::Measurement measurement = io::read_measurement(file, how);
  io::FrequencyResponseReadOptions options;
  options.how = how;
  options.quantity = quantity_of(asked.field);
  options.real_may_miss = true;
  const std::size_t before = data.size();
  for (const auto& scene : io::scenes_in(measurement)) {
    options.rows = scene;
    data.push_back({name + scene_text(scene), io::read_frequency_response(measurement, options)});
  }
  if (data.size() > before) return;
  const auto labels = how.select.empty() ? io::curve_labels(measurement, "") : std::vector<std::string>{};
  for (const auto& label : labels) {
    options.curve = label;
    data.push_back({name + ", curve " + label, io::read_frequency_response(measurement, options)});
  }
  if (data.size() == before) data.push_back({name, io::read_frequency_response(measurement, options)});
}

// The report puts files of these names into its folder.
bool would_be_replaced(const std::filesystem::path& input, const std::filesystem::path& folder) {
  std::error_code none;
  const auto inside = std::filesystem::weakly_canonical(input, none)
                          .lexically_relative(std::filesystem::weakly_canonical(folder, none));
  if (inside.empty()) return false;
  const std::string first = inside.begin()->string();
  return first == "tables" || first == "figures" || inside == "index.html" || inside == "results.json";
}

void refuse_inputs_in_folder(const ReportOptions& options) {
  auto inputs = options.data;
  if (options.scene) inputs.push_back(*options.scene);
  for (const auto& input : inputs)
    if (would_be_replaced(input, options.out))
      throw std::invalid_argument("--out " + options.out.string() + " holds the input " + input.string() +
                                  " where the report puts its own files; choose another folder");
}

Page page_of(const ReportOptions& options, const Scene& scene, std::vector<Section> sections,
             const std::string& trouble) {
  Page page;
  page.before_contents = options.data.empty() && !scene.contact ? 1 : 0;
  if (!options.data.empty()) {
    page.title = prose("page", "data-title");
    page.subtitle = prose("page", "data-subtitle");
  } else {
    page.title = prose("page", "scene-title");
    page.subtitle = scene.contact
                        ? prose("page", "contact-subtitle")
                        : prose("page", "scene-subtitle",
                                {{"origin", scene.of_the_paper ? prose("page", "paper") : prose("page", "own-scene")}});
  }
  if (!trouble.empty()) page.notice = prose("page", "no-pictures", {{"trouble", escape_html(trouble)}});
  page.sections = std::move(sections);
  return page;
}

}  // namespace

ReportOutcome write_report(const ReportOptions& options) {
  if (!options.data.empty() && options.scene) {
    throw std::invalid_argument("a report is either on data files or on a scene; both were given");
  }
#ifdef FRACFIT_BROWSER
  if (options.data.empty()) throw std::invalid_argument(gnuplot_missing());
#endif
  refuse_inputs_in_folder(options);
  StagedFolder folder(options.out);
  Stages stages(options);
  Work work;
  work.threads = options.threads;
  work.progress = options.progress;
  // Every file is read before the long work, so that a bad one is found at once.
  std::vector<Data> data;
  for (const auto& file : options.data) read_data(file, options, data);
  work.scene = options.scene ? read_scene(*options.scene) : paper_scene();

  const auto gnuplot = find_gnuplot();
  const auto draw = [&](const Section& section) { return draw_figures(folder, gnuplot, section); };
  std::vector<Section> sections;
  if (options.data.empty()) {
    sections = scene_sections(work, stages, draw);
  } else {
    std::vector<Chapter> chapters;
    for (std::size_t i = 0; i < data.size(); ++i) {
      chapters.push_back({"fits of " + data[i].name, 1, [&, i](const Work& w) {
                            const auto* record = std::get_if<TimeRecord>(&data[i].content);
                            return record ? time_section(w, data[i].name, record->data, record->notes, i + 1)
                                          : data_section(w, data[i].name,
                                                         std::get<io::FrequencyResponseFile>(data[i].content), i + 1,
                                                         options.field);
                          }});
    }
    sections = stages.write(chapters, work, draw);
  }
  const std::string& trouble = stages.trouble();
  Provenance provenance = provenance_of(options, work.scene);
  provenance.stages = stages.times();
  if (!options.data.empty() || work.scene.contact) sections.insert(sections.begin(), summary_section(sections));
  sections.push_back(provenance_section(provenance, sections));
  write_tables(folder, sections, provenance);
  folder.write("results.json", results_json(provenance, sections, trouble.empty()));
  const Page page = page_of(options, work.scene, std::move(sections), trouble);
  folder.write("index.html", page_html(page, folder.path()));
  folder.publish("index.html");

  const std::filesystem::path index = folder.target() / "index.html";
  if (trouble.empty()) return {true, "report written to " + index.string(), index};
  return {false, "report written to " + index.string() + " without pictures: " + trouble, index};
}

}  // namespace report
