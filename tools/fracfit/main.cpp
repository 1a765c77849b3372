#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "exit_code.hpp"
#include "io/data_error.hpp"
#include "io/output_file.hpp"
#include "io/sweep_file.hpp"
#include "solver_log.hpp"
#include "subcommand.hpp"
#include "wrapped_help.hpp"

namespace {

int complain(const char* message, int code) {
  std::fprintf(stderr, "fracfit: %s\n", message);
  return code;
}

std::string explained(const CLI::App& program, const CLI::ParseError& error, int argc, char** argv) {
  std::string message = error.what();
  std::string help = "fracfit";
  for (const auto* subcommand : program.get_subcommands()) help += " " + subcommand->get_name();
  if (program.get_subcommands().empty()) {
    message = argc > 1 ? "unknown subcommand or option " + io::quoted(argv[1]) : "no subcommand";
    std::string names;
    for (const auto* subcommand : program.get_subcommands([](const CLI::App*) { return true; }))
      names += (names.empty() ? "" : ", ") + subcommand->get_name();
    message += "; expected one of " + names;
  }
  return message + "\nSee '" + help + " --help'.";
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
  fracfit::silence_solver_log();
  try {
    CLI::App program("Fractional-order modelling and fitting; describing functions of two masses with backlash.",
                     "fracfit");
    program.formatter(fracfit::wrapped_help());  // subcommands inherit it
    program.set_version_flag("--version", "fracfit " + std::string(io::version()));
    program.require_subcommand(1);
    program.footer(
        "Examples:\n"
        "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 5:35:200log --out curve.csv\n"
        "  fracfit fit curve.csv --model power-law --where 'omega>20'\n"
        "  fracfit identify curve.csv\n"
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
