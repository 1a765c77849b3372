// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "choice.hpp"
#include "exit_code.hpp"
#include "io/data_error.hpp"
#include "io/output_file.hpp"
#include "io/sweep_file.hpp"
#include "io/termination.hpp"
#include "misspelling.hpp"
#include "solver_log.hpp"
#include "subcommand.hpp"
#include "wrapped_help.hpp"

namespace {

int complain(const char* message, int code) {
  std::fprintf(stderr, "fracfit: %s\n", message);
  return code;
}

std::vector<std::string> subcommand_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const auto* subcommand : program.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(subcommand->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& subcommand) {
  std::vector<std::string> names;
  for (const auto* option : subcommand.get_options([](const CLI::Option*) { return true; }))
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string unexpected(const CLI::App& subcommand) {
  const std::vector<std::string> extra = subcommand.remaining();
  const auto option = std::find_if(extra.begin(), extra.end(), [](const std::string& word) { return word[0] == '-'; });
  if (option == extra.end()) return "unexpected argument " + io::quoted(extra.front());
  const std::string name = option->substr(0, option->find('='));
  return "unknown option " + io::quoted(name) + fracfit::suggestion(name, option_names(subcommand));
}

std::string explained(const CLI::App& program, const CLI::ParseError& error, int argc, char** argv) {
  if (program.get_subcommands().empty()) {
    const std::vector<std::string> names = subcommand_names(program);
    return (argc > 1 ? "unknown subcommand or option " + io::quoted(argv[1]) + fracfit::suggestion(argv[1], names)
                     : std::string("no subcommand")) +
           "; expected one of " + fracfit::either(names) + "\nSee 'fracfit --help'.";
  }
  const CLI::App& subcommand = *program.get_subcommands().front();
  const bool is_extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !subcommand.remaining().empty();
  return (is_extra ? unexpected(subcommand) : error.what()) + "\nSee 'fracfit " + subcommand.get_name() + " --help'.";
}

int parse_and_run(CLI::App& program, const fracfit::Run& run, int argc, char** argv) {
  try {
    program.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    io::OutputFile("").write(program.help());
    return fracfit::usable_result;
  } catch (const CLI::CallForVersion& version) {
    io::OutputFile("").write(std::string(version.what()) + "\n");
    return fracfit::usable_result;
  } catch (const CLI::ParseError& error) {
    return complain(explained(program, error, argc, argv).c_str(), fracfit::wrong_usage);
  }
  return run();
}

}  // namespace

int main(int argc, char** argv) {
  // A reader that goes away, such as `head` or a dying gnuplot, is met where writing fails, not by a signal.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // the same for a limit of the size of files
  io::clean_up_on_signals();
  fracfit::silence_solver_log();
  try {
    CLI::App program("Fractional-order modelling and fitting; describing functions of two masses with backlash.",
                     "fracfit");
    program.formatter(fracfit::wrapped_help());  // subcommands inherit it
    program.set_version_flag("--version", "fracfit " + std::string(io::version()));
    program.require_subcommand(1);
    program.footer(
        "Examples:\n"
        "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 0.5:25:200 --out curve.csv\n"
        "  fracfit fit curve.csv --model power-law --where 'omega<4'\n"
        "  fracfit identify curve.csv --where 'omega<4'\n"
        "  fracfit report --out report\n"
        "Exit codes: 0 usable result, 1 no usable result, 2 wrong usage, 3 unreadable or invalid data.");
    fracfit::Run run;
    fracfit::add_simulate(program, run);
    fracfit::add_fit(program, run);
    fracfit::add_identify(program, run);
    fracfit::add_identify_scene(program, run);
    fracfit::add_batch(program, run);
    fracfit::add_merge(program, run);
    fracfit::add_jump_law(program, run);
    fracfit::add_approximate(program, run);
    fracfit::add_controller(program, run);
    fracfit::add_realise(program, run);
    fracfit::add_tune(program, run);
    fracfit::add_analyse(program, run);
    fracfit::add_respond(program, run);
    fracfit::add_mittag_leffler(program, run);
    fracfit::add_orbits(program, run);
    fracfit::add_map(program, run);
    fracfit::add_history(program, run);
    fracfit::add_basins(program, run);
    fracfit::add_report(program, run);
    fracfit::add_shell_help(program, run);
    return parse_and_run(program, run, argc, argv);
  } catch (const io::DataError& error) {
    return complain(error.what(), fracfit::invalid_data);
  } catch (const std::invalid_argument& error) {
    return complain(error.what(), fracfit::wrong_usage);
  } catch (const std::domain_error& error) {
    return complain(error.what(), fracfit::wrong_usage);
  } catch (const std::filesystem::filesystem_error& error) {
    return complain(error.what(), fracfit::wrong_usage);
  } catch (const io::OutputClosed&) {
    return fracfit::no_usable_result;
  } catch (const std::bad_alloc&) {
    return complain("out of memory", fracfit::no_usable_result);
  } catch (const std::exception& error) {
    return complain(error.what(), fracfit::no_usable_result);
  }
}
