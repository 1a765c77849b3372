// SPDX-License-Identifier: BSD-3-Clause
#include <csignal>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "commands/solver_log.hpp"
#include "commands/subcommand.hpp"
#include "io/data_error.hpp"
#include "io/output_file.hpp"
#include "io/termination.hpp"
#include "options/parser.hpp"

namespace {

int fail(const std::string& message, int code) {
  fracfit::complain(message);
  return code;
}

// Vectors of large data come and go many times.  Handed back to the system each time, their pages are made anew and
// filled with zeros, which takes a quarter of the time of a fit to 10^6 points.
void keep_memory() {
#ifdef __GLIBC__
  constexpr int kept = 1 << 30;
  mallopt(M_TRIM_THRESHOLD, kept);
  mallopt(M_MMAP_MAX, 0);
#endif
}

int run(const std::vector<std::string>& arguments) {
  const auto groups = fracfit::all_commands();
  const fracfit::Request request = fracfit::parse(groups, arguments);
  if (request.command != nullptr) return request.command->execute();
  io::OutputFile("").write(request.page);
  return fracfit::usable_result;
}

}  // namespace

int main(int argc, char** argv) {
  // A reader may go away, such as `head` or a dying gnuplot.  The write then fails instead of a signal ending the
  // program.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // the same for a limit of the size of files
  keep_memory();
  io::clean_up_on_signals();
  fracfit::silence_solver_log();
  try {
    return run(std::vector<std::string>(argv + 1, argv + argc));
  } catch (const io::DataError& error) {
    return fail(error.what(), fracfit::invalid_data);
  } catch (const std::invalid_argument& error) {
    return fail(error.what(), fracfit::wrong_usage);
  } catch (const std::domain_error& error) {
    return fail(error.what(), fracfit::wrong_usage);
  } catch (const std::filesystem::filesystem_error& error) {
    // Lack of memory or threads is a failure (exit code 1), not wrong usage.
    const bool is_of_machine = error.code() == std::errc::no_space_on_device || error.code() == std::errc::io_error;
    return fail(error.path1().string() + ": " + error.code().message(),
                is_of_machine ? fracfit::no_usable_result : fracfit::wrong_usage);
  } catch (const io::OutputClosed&) {
    return fracfit::no_usable_result;
  } catch (const std::bad_alloc&) {
    return fail("out of memory", fracfit::no_usable_result);
  } catch (const std::exception& error) {
    return fail(error.what(), fracfit::no_usable_result);
  }
}
