// SPDX-License-Identifier: BSD-3-Clause
// Every command that writes files meets every kind of fault at every call that writes.  What must hold: the target is
// the old file or the complete new one; an error is exit code 1 and a sentence with its cause; nothing else is left.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "tools/run_program.hpp"

namespace {

namespace fs = std::filesystem;

struct Command {
  std::string name;
  std::vector<std::string> arguments;  // --out follows
  std::string target = "target";
};

class Faults : public testing::Test {
 protected:
  Faults() {
    std::string curve = "omega_rad_s,re,im\n";
    for (int i = 1; i <= 8; ++i) curve += std::to_string(i) + ",1," + std::to_string(-0.5 * i) + "\n";
    folder.write("curve.csv", curve);
    folder.write("short.csv", "omega_rad_s,re,im\n1,1,-1\n2,1,-1\n");
    fs::create_directory(folder.path("work"));
  }

  [[nodiscard]] std::string path(const std::string& name) const { return folder.path("work/" + name); }

  // Names in the work folder, those of its folders with a slash.
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(folder.path("work"))) all.push_back(entry.path().filename());
    return all;
  }

  [[nodiscard]] ProgramResult run_with(const std::vector<std::string>& arguments, const std::string& fault,
                                       bool named) {
    fs::remove(folder.path("fired"));
    ProgramSetting setting{.environment = {{"LD_PRELOAD", FRACFIT_FAULT_LIBRARY},
                                           {"FRACFIT_FAULT", fault},
                                           {"FRACFIT_FAULT_LOG", folder.path("fired")}}};
    if (named) setting.environment.emplace_back("FRACFIT_NAMED", "1");
    ++runs;
    return run_fracfit(arguments, setting);
  }

  [[nodiscard]] bool fired() const { return fs::exists(folder.path("fired")); }

  // Tries the faults one after another until a run ends without meeting one.
  void try_all(const Command& command, const std::string& kind, bool exists, bool named) {
    const auto target = path(command.target);
    auto arguments = command.arguments;
    arguments.insert(arguments.end(), {"--out", target, "--quiet"});
    fs::remove(target);
    ASSERT_EQ(run_fracfit(arguments).code, 0) << command.name;
    const std::string complete = lasting(content_of(target));
    for (int call = 1;; ++call) {
      ASSERT_LT(call, 60) << command.name;
      const std::string fault = kind + "@" + std::to_string(call);
      SCOPED_TRACE(command.name + " " + fault + (named ? " named" : "") + (exists ? " over a file" : ""));
      fs::remove(target);
      if (exists) folder.write("work/" + command.target, "old\n");
      const auto result = run_with(arguments, fault, named);
      if (!fired()) {
        EXPECT_EQ(result.code, 0) << result.error;
        break;
      }
      ++faults;
      const bool is_complete = fs::exists(target) && lasting(content_of(target)) == complete;
      const bool is_old = exists ? fs::exists(target) && content_of(target) == "old\n" : !fs::exists(target);
      EXPECT_TRUE(is_complete || is_old);
      if (kind == "kill") {
        EXPECT_EQ(result.code, -SIGKILL);
        clear_after_kill(complete, named);
        continue;
      }
      EXPECT_EQ(names(), is_old && !exists ? std::vector<std::string>{} : std::vector<std::string>{command.target});
      if (kind == "short" || kind == "EINTR") {
        EXPECT_EQ(result.code, 0) << result.error;
        EXPECT_TRUE(is_complete);
      } else if (result.code != 0) {
        EXPECT_EQ(result.code, 1);
        EXPECT_TRUE(is_old);
        EXPECT_NE(result.error.find(cause_of(kind)), std::string::npos) << result.error;
        EXPECT_NE(result.error.find(command.target), std::string::npos) << result.error;
      } else {
        EXPECT_TRUE(is_complete);
      }
    }
  }

  [[nodiscard]] static std::string cause_of(const std::string& kind) {
    return kind == "ENOSPC" ? "No space left on device" : kind == "EIO" ? "Input/output error" : "Disk quota exceeded";
  }

  // A result without the time it took.
  [[nodiscard]] static std::string lasting(const std::string& text) {
    std::string rest;
    for (const auto& line : lines_of(text))
      if (line.find("\"seconds\"") == std::string::npos) rest += line + "\n";
    return rest;
  }

  // Nobody can tidy up after SIGKILL.  A file without a name leaves nothing, but for the moment between its naming and
  // its taking the place of the target, when it is complete.
  void clear_after_kill(const std::string& complete, bool named) {
    for (const auto& name : names()) {
      if (!name.starts_with('.')) continue;
      if (!named) {
        EXPECT_EQ(lasting(content_of(path(name))), complete);
      }
      fs::remove(path(name));
    }
  }

  // What a run says, but for the line that it went on with an interrupted one.
  [[nodiscard]] static std::vector<std::string> notes_of(const ProgramResult& result) {
    std::vector<std::string> notes;
    for (const auto& line : lines_of(result.error))
      if (line.find(".partial") == std::string::npos) notes.push_back(line);
    return notes;
  }

  // Faults the run one call after another; the same command again must give the table and the notes of a run without
  // faults.
  void goes_on_after_any_fault(const std::vector<std::string>& arguments, const std::string& out,
                               std::size_t notes = 0) {
    const auto undisturbed = run_fracfit(arguments);
    ASSERT_EQ(undisturbed.code, 0);
    EXPECT_EQ(notes_of(undisturbed).size(), notes) << undisturbed.error;
    const auto complete = content_of(out);
    for (const std::string kind : {"ENOSPC", "EIO", "short", "EINTR", "kill"}) {
      for (int call = 1;; ++call) {
        ASSERT_LT(call, 60);
        SCOPED_TRACE(kind + "@" + std::to_string(call));
        for (const auto& name : names()) fs::remove(path(name));
        const auto result = run_with(arguments, kind + "@" + std::to_string(call), false);
        if (!fired()) break;
        ++faults;
        if (kind == "ENOSPC" || kind == "EIO") {
          EXPECT_TRUE(result.code == 0 || result.code == 1) << result.code;
          if (result.code != 0) {
            EXPECT_NE(result.error.find(cause_of(kind)), std::string::npos) << result.error;
          }
        }
        if (kind == "short" || kind == "EINTR") {
          EXPECT_EQ(result.code, 0);
        }
        if (kind != "kill") {
          EXPECT_LE(names().size(), 1U);
        }
        clear_after_kill(complete, true);
        const auto again = run_fracfit(arguments);
        EXPECT_EQ(again.code, 0) << again.error;
        EXPECT_EQ(notes_of(again), notes_of(undisturbed));
        EXPECT_EQ(content_of(out), complete);
      }
    }
    RecordProperty("faults", faults);
  }

  TemporaryFolder folder;
  int faults = 0, runs = 0;
};

TEST_F(Faults, AnOutputIsWholeOrNotThereAtAll) {
  const Command command{"mittag-leffler", {"mittag-leffler", "--alpha", "0.5", "--beta", "1", "--z", "-1"}};
  for (const char* kind : {"ENOSPC", "EIO", "EDQUOT", "short", "EINTR", "kill"})
    for (const bool exists : {false, true})
      for (const bool named : {false, true}) try_all(command, kind, exists, named);
  RecordProperty("faults", faults);
}

// Commands that keep what they have found in FILE.partial have tests of their own below.
TEST_F(Faults, EveryCommandMeetsAFullDiskAndAKill) {
  const std::vector<std::string> scene{"--force", "20", "--clearance", "0.3", "--restitution", "0.6"};
  const auto with = [](std::vector<std::string> arguments, const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const auto curve = folder.path("curve.csv");
  for (const auto& command : std::vector<Command>{
           {"simulate as JSON", with(with({"simulate"}, scene), {"--omega", "5:6:2", "--format", "json"})},
           {"fit", {"fit", curve, "--model", "K/(T s + 1)", "--component", "both"}},
           {"identify", {"identify", curve, "--models", "gain,lag"}},
           {"approximate", {"approximate", "--order", "0.5", "--band", "0.1:10", "--poles", "3"}},
           {"controller", {"controller", "--kp", "1", "--sample-time", "0.01", "--band", "0.1:10"}},
           {"respond", {"respond", "--model", "1/(s + 1)", "--time", "0:1:3"}},
           {"analyse", {"analyse", "--model", "1/(s + 1)"}},
           {"convert", {"convert", curve}},
           {"orbits", {"orbits", "--restitution", "0.6", "--from", "1.3", "--to", "1.4"}},
           {"jump-law", {"jump-law", "--force", "20,40", "--clearance", "0.2,0.3", "--restitution", "0.6"}},
           {"realise", {"realise", "--model", "1/(s^0.5 + 1)", "--band", "0.1:10", "--tolerance", "0.1"}},
           {"history", with(with({"history"}, scene), {"--omega", "5"})},
           {"batch without rows kept", {"batch", curve, "--model", "gain"}, "rows.jsonl"}}) {
    fs::remove(path(command.target));
    const auto result = run_fracfit(with(command.arguments, {"--out", path(command.target), "--quiet"}));
    if (result.code != 0) {
      ADD_FAILURE() << command.name << ": " << result.error;
      continue;
    }
    if (command.name.starts_with("batch")) continue;
    for (const char* kind : {"ENOSPC", "kill"}) try_all(command, kind, true, false);
    fs::remove(path(command.target));
  }
  RecordProperty("faults", faults);
}

// A limit of threads, as `ulimit -u` and containers set it: what the program is refused it does without.
TEST_F(Faults, RefusedThreadsChangeNoResult) {
  const auto curve = folder.path("curve.csv");
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"fit", curve, "--model", "K/(T s + 1)", "--component", "both"},
           {"identify", curve, "--models", "gain,lag"},
           {"map", "--restitution", "0.3,0.6", "--omega", "1:2:4"},
           {"basins", "--restitution", "0.6", "--omega", "1.41", "--position", "0:0.5:2", "--velocity", "0:1:2"},
           {"batch", curve, folder.path("short.csv"), "--model", "gain", "--component", "both"},
           {"respond", "--model", "1/(s^0.5 + 1)", "--time", "0:1:20"}}) {
    const auto run = [&](const std::string& fault) {
      auto all = arguments;
      all.insert(all.end(), {"--threads", "4", "--out", path("target"), "--quiet"});
      fs::remove(path("target"));
      const auto result = run_with(all, fault, false);
      EXPECT_EQ(result.code, 0) << arguments.front() << ' ' << fault << ": " << result.error;
      return lasting(content_of(path("target")));
    };
    const std::string undisturbed = run("threads@100000");
    EXPECT_FALSE(fired());
    for (const char* fault : {"threads@1", "threads@2", "threads@3"}) {
      EXPECT_EQ(run(fault), undisturbed) << arguments.front() << ' ' << fault;
      EXPECT_TRUE(fired() || std::string(fault) != "threads@1") << arguments.front();
    }
  }
}

// A batch keeps its finished rows on disk, so a fault leaves part of them: the same command again must give the table
// of a run without faults.
TEST_F(Faults, ABatchGoesOnAfterAnyFault) {
  for (int i = 0; i < 4; ++i) {
    std::string curve = "omega_rad_s,re,im\n";
    for (int k = 1; k <= 6; ++k) curve += std::to_string(k) + "," + std::to_string(1 + i) + ",0.1\n";
    folder.write("data" + std::to_string(i) + ".csv", curve);
  }
  std::vector<std::string> arguments{"batch"};
  for (int i = 0; i < 4; ++i) arguments.push_back(folder.path("data" + std::to_string(i) + ".csv"));
  const auto out = path("rows.csv");
  for (const auto& word : {"--model", "gain", "--component", "both", "--quiet", "--out"}) arguments.emplace_back(word);
  arguments.push_back(out);
  goes_on_after_any_fault(arguments, out);
}

// So do the sweeps, beside their output.
TEST_F(Faults, ASweepGoesOnAfterAnyFault) {
  const auto out = path("map.csv");
  goes_on_after_any_fault({"map", "--force", "20", "--clearance", "0.3", "--restitution", "0.5,0.6,0.7", "--omega",
                           "5:6:2", "--quiet", "--out", out},
                          out);
  goes_on_after_any_fault({"simulate", "--force", "20", "--clearance", "0.3", "--restitution", "0.6", "--omega",
                           "5:6:5", "--protocol", "contact-at-rest", "--quiet", "--out", out},
                          out);
}

// What is said of the points counts those of the interrupted run too: of these two, the first one follows an orbit
// that rounding decides on.
TEST_F(Faults, NotesCountWhatAnInterruptedRunHasLeft) {
  const auto out = path("curve.csv");
  goes_on_after_any_fault({"simulate", "--force", "1", "--clearance", "1", "--restitution", "0.9", "--omega",
                           "0.6661849837985103,0.7", "--protocol", "contact-at-rest", "--diagnostics", "--out", out},
                          out, 1);
}

// A search for basins keeps where each start leads, and then where those lead that it follows on.
TEST_F(Faults, ASearchForBasinsGoesOnAfterAnyFault) {
  const auto out = path("basins.csv");
  goes_on_after_any_fault({"basins", "--restitution", "0.85067", "--omega", "0.9743", "--position", "0.05:0.95:6",
                           "--velocity", "-1:1:6", "--quiet", "--out", out},
                          out);
}

// So does a study of the noise, refit by refit.
TEST_F(Faults, ABootstrapGoesOnAfterAnyFault) {
  const auto out = path("refits.csv");
  goes_on_after_any_fault({"fit", folder.path("curve.csv"), "--model", "K/(T s + 1)", "--component", "both",
                           "--bootstrap", "20", "--quiet", "--refits", out},
                          out);
}

// A report is a folder: each of its files is old or new, the page comes last, and the folder under construction goes.
TEST_F(Faults, AReportThatFailsLeavesNoFolderUnderConstruction) {
  const auto gnuplot = folder.write("gnuplot",
                                    "#!/bin/sh\nfor n in \"$@\"; do case $n in *.gp) n=${n%.gp}\n"
                                    "printf '<svg xmlns=\"http://www.w3.org/2000/svg\"></svg>' > $n.svg\n"
                                    "printf 'PNG IEND....' > $n.png;; esac; done\n");
  fs::permissions(gnuplot, fs::perms::owner_all);
  const auto out = path("report");
  const std::vector<std::string> arguments{"report", folder.path("short.csv"), "--out", out, "--quiet"};
  const std::string search_path = folder.path() + ":/bin:/usr/bin";
  for (const std::string kind : {"ENOSPC", "EIO"}) {
    int step = 1;
    for (int call = 1;; call += step, step += 1) {
      ASSERT_LT(call, 2000);
      SCOPED_TRACE(kind + "@" + std::to_string(call));
      fs::remove_all(out);
      fs::remove(folder.path("fired"));
      const auto result = run_fracfit(arguments, {.search_path = search_path,
                                                  .environment = {{"LD_PRELOAD", FRACFIT_FAULT_LIBRARY},
                                                                  {"FRACFIT_FAULT", kind + "@" + std::to_string(call)},
                                                                  {"FRACFIT_FAULT_LOG", folder.path("fired")}}});
      if (!fired()) {
        EXPECT_EQ(result.code, 0) << result.error;
        break;
      }
      ++faults;
      EXPECT_EQ(result.code, 1) << result.error;
      EXPECT_NE(result.error.find(cause_of(kind)), std::string::npos) << result.error;
      EXPECT_FALSE(fs::exists(out + "/index.html"));
      if (!fs::exists(out)) continue;
      for (const auto& entry : fs::directory_iterator(out))
        EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
    }
  }
  RecordProperty("faults", faults);
}

TEST_F(Faults, SignalsLeaveNothingBehind) {
  // Long enough to be met in the middle; the folder of the report is there from the beginning.
  const std::string script = "env --default-signal=INT \"$fracfit\" report --out " + path("report") +
                             " --quiet & child=$!; "
                             "for i in $(seq 400); do ls -d " +
                             path("report") +
                             "/.report-* >/dev/null 2>&1 && break; sleep 0.05; done; "
                             "kill -SIGNAL $child; wait $child; echo $?";
  for (const auto& [signal, code] : std::vector<std::pair<std::string, std::string>>{{"TERM", "143"}, {"INT", "130"}}) {
    std::string commands = script;
    commands.replace(commands.find("SIGNAL"), 6, signal);
    // A shell without job control starts programs in the background with SIGINT ignored, as may who starts the tests.
    const auto result = run_shell("set -m; " + commands);
    EXPECT_EQ(result.output, code + "\n") << result.error;
    EXPECT_TRUE(names().empty());
  }
}

TEST(FullDisk, ExitsWithOneAndItsCauseWhereverTheOutputGoes) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  for (const std::string& arguments : std::vector<std::string>{
           "--help", "--version", "fit --help", "man", "completion", "mittag-leffler --alpha 0.5 --beta 1 --z -1",
           "analyse --model '1/(s+1)'", "respond --model '1/(s+1)' --time 0:1:3",
           "approximate --order 0.5 --band 0.1:10 --poles 3",
           "simulate --force 20 --clearance 0.3 --restitution 0.6 --omega 5:6:2"}) {
    const auto result = run_shell("\"$fracfit\" " + arguments + " > /dev/full");
    EXPECT_EQ(result.code, 1) << arguments;
    EXPECT_NE(result.error.find("No space left on device"), std::string::npos) << arguments << ": " << result.error;
  }
}

// A limit of the size of files works on every write, also of a program that fracfit starts.
TEST(FileSizeLimit, IsAnErrorWithItsCause) {
  const TemporaryFolder folder;
  const auto out = folder.path("out.csv");
  const auto result = run_shell("ulimit -f 1; \"$fracfit\" respond --model '1/(s+1)' --time 0:1:1001 --out " + out);
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.error.find("File too large"), std::string::npos) << result.error;
  EXPECT_EQ(folder.entries(), 0U);
}

// With less and less memory or threads the program does its work or says in a sentence that it cannot.
TEST(Limits, OfMemoryAndThreadsEndInASentence) {
  const TemporaryFolder folder;
  const auto data = folder.write("curve.csv", "omega_rad_s,re,im\n1,1,-1\n2,1,-2\n3,1,-3\n4,1,-4\n5,1,-5\n");
  for (const std::string& arguments : std::vector<std::string>{
           "fit " + data + " --model 'K/(T s^a + 1)' --component both", "identify " + data + " --models gain,lag",
           "simulate --force 20 --clearance 0.3 --restitution 0.6 --omega 5:6:20",
           "respond --model '1/(s^0.5+1)' --time 0:1:20001"}) {
    for (const std::string limit : {"-v 100000", "-v 130000", "-v 160000", "-v 200000", "-v 260000", "-v 400000"}) {
      const auto result = run_shell("ulimit " + limit + "; \"$fracfit\" " + arguments + " --threads 8 --out /dev/null");
      // 127: the loader itself found no room for the shared libraries.
      EXPECT_TRUE(result.code == 0 || result.code == 1 || result.code == 127)
          << limit << " " << arguments << ": " << result.code << " " << result.error;
      if (result.code != 0) {
        EXPECT_FALSE(result.error.empty());
      }
    }
  }
}

}  // namespace
