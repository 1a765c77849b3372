// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "run_program.hpp"

namespace {

std::vector<std::string> map(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"map",     "--force",    "40",        "--clearance", "0.3",
                                     "--omega", "5:35:12log", "--threads", "2",           "--quiet"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(Map, WritesARowPerPointWithScene) {
  const auto result = run_fracfit(map({"--restitution", "0.2,0.6"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto lines = lines_of(result.output);
  std::size_t rows = 0;
  bool has_columns = false;
  for (const std::string& line : lines) {
    if (line.starts_with("# ")) continue;
    if (!has_columns) {
      EXPECT_EQ(line,
                "restitution,omega_rad_s,re_m_per_n,im_m_per_n,regime,period,impacts_per_period,uncertainty_m_per_n,"
                "third_harmonic_ratio,even_harmonic_ratio,energy_defect,lyapunov_exponent,periods_followed,transient_"
                "possible,"
                "force_sensitivity");
      has_columns = true;
      continue;
    }
    EXPECT_TRUE(line.starts_with(rows < 12 ? "0.2," : "0.6,")) << line;
    ++rows;
  }
  EXPECT_EQ(rows, 24u);
  EXPECT_NE(result.output.find("# force_n: 40\n"), std::string::npos);
  EXPECT_NE(result.output.find("--mean-tolerance 0.01"), std::string::npos);
}

TEST(Map, ARowIsWhatSimulateGivesWithFullMeans) {
  const auto result = run_fracfit(map({"--restitution", "0.6", "--mean-tolerance", "0"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto sweep = run_fracfit({"simulate", "--force", "40", "--clearance", "0.3", "--restitution", "0.6", "--omega",
                                  "5:35:12log", "--diagnostics"});
  ASSERT_EQ(sweep.code, 0) << sweep.error;
  const auto rows = lines_of(result.output);
  const auto expected = lines_of(sweep.output);
  ASSERT_GT(rows.size(), 12u);
  for (std::size_t i = 1; i <= 12; ++i) EXPECT_EQ(rows[rows.size() - i], "0.6," + expected[expected.size() - i]);
}

TEST(Map, ShardsJoinToTheWholeInAnyOrder) {
  const TemporaryFolder folder;
  const std::vector<std::string> grid{"--restitution", "0.1:0.9:5"};
  const auto run = [&](const std::string& name, const std::vector<std::string>& more) {
    auto arguments = map(grid);
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.insert(arguments.end(), {"--out", folder.path(name)});
    const auto result = run_fracfit(arguments);
    ASSERT_EQ(result.code, 0) << result.error;
  };
  run("whole.csv", {});
  run("1.csv", {"--shard", "1/3"});
  run("2.csv", {"--shard", "2/3"});
  run("3.csv", {"--shard", "3/3"});
  const auto joined = run_fracfit(
      {"merge", "--out", folder.path("joined.csv"), folder.path("3.csv"), folder.path("1.csv"), folder.path("2.csv")});
  ASSERT_EQ(joined.code, 0) << joined.error;
  EXPECT_EQ(content_of(folder.path("joined.csv")), content_of(folder.path("whole.csv")));

  const auto missing = run_fracfit({"merge", "--out", "-", folder.path("1.csv"), folder.path("3.csv")});
  EXPECT_EQ(missing.code, 3);
  EXPECT_NE(missing.error.find("shard 2/3 is missing"), std::string::npos) << missing.error;
  const auto twice = run_fracfit({"merge", "--out", "-", folder.path("1.csv"), folder.path("1.csv")});
  EXPECT_EQ(twice.code, 3);
  EXPECT_NE(twice.error.find("shard 1"), std::string::npos) << twice.error;
  run("other.csv", {"--shard", "2/3", "--protocol", "sweep-down"});
  const auto other = run_fracfit({"merge", "--out", "-", folder.path("1.csv"), folder.path("other.csv")});
  EXPECT_EQ(other.code, 3);
  EXPECT_NE(other.error.find("another command"), std::string::npos) << other.error;
}

TEST(Map, ShardsOfContactsJoinToTheWholeOfMapAndSimulate) {
  for (const std::string command : {"map", "simulate"}) {
    const TemporaryFolder folder;
    const auto run = [&](const std::string& name, const std::vector<std::string>& more) {
      std::vector<std::string> arguments{command,       "--force",
                                         "40",          "--clearance",
                                         "0.3",         "--contact-frequency",
                                         "200,400,600", "--contact-restitution",
                                         "0.5,0.7",     "--friction1",
                                         "2",           "--omega",
                                         "19:22:4",     "--quiet",
                                         "--out",       folder.path(name)};
      arguments.insert(arguments.end(), more.begin(), more.end());
      const auto result = run_fracfit(arguments);
      ASSERT_EQ(result.code, 0) << result.error;
    };
    run("whole.csv", {});
    std::vector<std::string> merge{"merge", "--out", folder.path("joined.csv")};
    for (const char* shard : {"1/4", "2/4", "3/4", "4/4"}) {
      run(std::string(1, *shard) + ".csv", {"--shard", shard});
      merge.push_back(folder.path(std::string(1, *shard) + ".csv"));
    }
    const auto joined = run_fracfit(merge);
    ASSERT_EQ(joined.code, 0) << joined.error;
    EXPECT_EQ(content_of(folder.path("joined.csv")), content_of(folder.path("whole.csv")));
    // The whole of other friction is another table.
    run("other.csv", {"--shard", "2/4", "--friction2", "1"});
    const auto other = run_fracfit({"merge", "--out", "-", folder.path("1.csv"), folder.path("other.csv")});
    EXPECT_EQ(other.code, 3);
    EXPECT_NE(other.error.find("another command"), std::string::npos) << other.error;
  }
}

// More shards than restitutions leave some empty; they join all the same.
TEST(Map, ShardsMayBeMoreThanRows) {
  const TemporaryFolder folder;
  std::vector<std::string> merge{"merge", "--out", "-"};
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    const auto part = folder.path(std::string(1, *shard) + ".csv");
    ASSERT_EQ(run_fracfit(map({"--restitution", "0.2,0.4", "--shard", shard, "--out", part})).code, 0);
    merge.push_back(part);
  }
  const auto joined = run_fracfit(merge);
  ASSERT_EQ(joined.code, 0) << joined.error;
  EXPECT_EQ(joined.output, run_fracfit(map({"--restitution", "0.2,0.4"})).output);
}

TEST(Map, SaysHowFarShardsAreAndWhichToRunAgain) {
  const TemporaryFolder folder;
  const auto run = [&](const std::string& shard) {
    const auto result =
        run_fracfit(map({"--restitution", "0.1:0.9:6", "--shard", shard, "--out", folder.path("{shard}.csv")}));
    EXPECT_EQ(result.code, 0) << result.error;
  };
  for (const char* shard : {"1/6", "2/6", "6/6"}) run(shard);
  folder.write("2-of-6.csv", content_of(folder.path("2-of-6.csv")).substr(0, 900));
  const auto merged = run_fracfit({"merge", folder.path("1-of-6.csv"), folder.path("6-of-6.csv"), "--out", "-"});
  EXPECT_EQ(merged.code, 3);
  EXPECT_NE(merged.error.find("--array=2-5"), std::string::npos) << merged.error;
  const auto status = run_fracfit({"merge", folder.path("1-of-6.csv"), folder.path("2-of-6.csv"),
                                   folder.path("6-of-6.csv"), "--status", "--format", "json"});
  EXPECT_EQ(status.code, 1) << status.error;
  const auto json = nlohmann::json::parse(status.output);
  EXPECT_EQ(json["shards_to_do"], "2-5");
  EXPECT_EQ(json["rows"][0]["state"], "finished");
  EXPECT_EQ(json["rows"][0]["rows"], 12);
  EXPECT_NE(json["rows"][1]["state"].get<std::string>().find("ends after"), std::string::npos) << status.output;
}

// What a batch system or a launcher says in the environment of each task.
TEST(Map, TakesItsShardFromTheEnvironment) {
  using Variables = std::vector<std::pair<std::string, std::string>>;
  const auto run = [](const std::string& shard, Variables variables) {
    return run_fracfit(map({"--restitution", "0.2,0.4", "--shard", shard}), {.environment = std::move(variables)});
  };
  const auto expect_shard = [&](const std::string& shard, const Variables& variables, const std::string& expected) {
    const auto result = run(shard, variables);
    EXPECT_EQ(result.code, 0) << result.error;
    EXPECT_NE(result.output.find("\n# shard: " + expected + "\n"), std::string::npos) << result.output;
  };
  expect_shard("auto", {{"SLURM_ARRAY_TASK_ID", "2"}, {"SLURM_ARRAY_TASK_MIN", "1"}, {"SLURM_ARRAY_TASK_MAX", "4"}},
               "2/4");
  expect_shard("auto/9", {{"SLURM_ARRAY_TASK_ID", "7"}, {"SLURM_ARRAY_TASK_MIN", "7"}, {"SLURM_ARRAY_TASK_MAX", "7"}},
               "7/9");
  expect_shard("auto", {{"SGE_TASK_ID", "3"}, {"SGE_TASK_FIRST", "1"}, {"SGE_TASK_LAST", "3"}}, "3/3");
  expect_shard("auto", {{"SGE_TASK_ID", "undefined"}, {"OMPI_COMM_WORLD_RANK", "0"}, {"OMPI_COMM_WORLD_SIZE", "2"}},
               "1/2");
  expect_shard("auto", {{"PMI_RANK", "4"}, {"PMI_SIZE", "5"}}, "5/5");
  expect_shard("auto", {{"SLURM_PROCID", "1"}, {"SLURM_NTASKS", "3"}}, "2/3");
  expect_shard("auto/3", {{"PMIX_RANK", "2"}}, "3/3");
  expect_shard("auto", {{"PMIX_RANK", "0"}, {"OMPI_COMM_WORLD_RANK", "1"}, {"OMPI_COMM_WORLD_SIZE", "2"}}, "2/2");
  expect_shard("auto/6", {{"PBS_ARRAY_INDEX", "6"}}, "6/6");
  expect_shard("auto/6", {{"JOB_COMPLETION_INDEX", "0"}}, "1/6");
  // Two ranks in each of three tasks are six shards.
  expect_shard("auto",
               {{"SLURM_ARRAY_TASK_ID", "3"},
                {"SLURM_ARRAY_TASK_MIN", "1"},
                {"SLURM_ARRAY_TASK_MAX", "3"},
                {"SLURM_PROCID", "0"},
                {"SLURM_NTASKS", "2"}},
               "5/6");
  for (const auto& [shard, variables, part] : std::vector<std::tuple<std::string, Variables, std::string>>{
           {"auto", {}, "expected i/n"},
           {"auto", {{"PBS_ARRAY_INDEX", "2"}}, "expected auto/n"},
           {"auto", {{"PMIX_RANK", "2"}}, "expected auto/n"},
           {"auto/4", {{"PBS_ARRAY_INDEX", "2"}, {"PMIX_RANK", "1"}}, "outside of an array"},
           {"auto/2", {{"PMIX_RANK", "2"}}, "at most 2"},
           {"auto",
            {{"SLURM_ARRAY_TASK_ID", "3"}, {"SLURM_ARRAY_TASK_MIN", "3"}, {"SLURM_ARRAY_TASK_MAX", "5"}},
            "not 1-n"},
           {"auto/4", {{"SLURM_ARRAY_TASK_ID", "0"}}, "counted from 1"},
           {"auto/4", {{"SLURM_ARRAY_TASK_ID", "5"}}, "at most 4"},
           {"auto/4", {{"PMI_RANK", "0"}, {"PMI_SIZE", "3"}}, "3 processes"}}) {
    const auto result = run(shard, variables);
    EXPECT_EQ(result.code, 2) << part;
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  }
}

// Programs that stand for the batch system run the tasks at once, one after the other.
TEST(ClusterScript, RunsAllShardsAndJoinsThemUnderSlurmAndGnuParallel) {
  const TemporaryFolder folder;
  const auto program = [&](const std::string& name, const std::string& text) {
    namespace fs = std::filesystem;
    fs::permissions(folder.write(name, "#!/bin/bash\n" + text), fs::perms::owner_all);
  };
  program("sbatch",
          "for word in \"$@\"; do case $word in --array=*) array=${word#*=} ;; --*) ;; *) script+=(\"$word\") ;; esac; "
          "done\n"
          "[ -n \"$array\" ] || exec bash \"${script[@]}\"\n"
          "for i in $(seq ${array%-*} ${array#*-}); do SLURM_ARRAY_TASK_ID=$i bash \"${script[@]}\" || exit; "
          "done\necho 1\n");
  program("parallel", "while read -r i; do bash -c \"${@:3:1} $i\" || exit; done\n");
  const auto whole = folder.path("whole.csv");
  const auto request = map({"--restitution", "0.1:0.9:5", "--out"});
  for (const char* system : {"--slurm", "--parallel"}) {
    const auto joined = folder.path(std::string("joined") + system + ".csv");
    std::vector<std::string> arguments{"cluster-script", system, "--shards", "3"};
    for (const auto& word : request)
      if (word != "--threads" && word != "2") arguments.push_back(word);
    arguments.push_back(joined);
    const auto script = run_fracfit(arguments);
    ASSERT_EQ(script.code, 0) << script.error;
    const auto ran = run_program("/bin/bash", {folder.write("job.sh", script.output)},
                                 {.search_path = folder.path() + ":/usr/bin:/bin"});
    ASSERT_EQ(ran.code, 0) << ran.error;
    auto direct = request;
    direct.push_back(whole);
    ASSERT_EQ(run_fracfit(direct).code, 0);
    EXPECT_EQ(content_of(joined), content_of(whole)) << system;
  }
  for (const auto& [arguments, part] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{}, "expected a command"},
           {{"fit", "x.csv"}, "expected map, simulate or batch"},
           {map({"--restitution", "0.2"}), "--threads of map"},
           {{"map", "--restitution", "0.2", "--omega", "1"}, "--out of map is required"},
           {{"map", "--restitution", "0.2", "--omegas", "1"}, "did you mean --omega"}}) {
    std::vector<std::string> all{"cluster-script", "--slurm"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const auto result = run_fracfit(all);
    EXPECT_EQ(result.code, 2) << part;
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  }
}

TEST(Map, SaysWhatIsWrong) {
  for (const auto& [more, part] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--restitution", "0.2,1.5"}, "restitution[1] is 1.5"},
           {{"--restitution", "0.2", "--shard", "3/2"}, "--shard"},
           {{"--restitution", "0.2", "--mean-tolerance", "2"}, "--mean-tolerance"},
           {{"--restitution", "0.2", "--protocol", "sideways"}, "sideways"},
           {{}, "--restitution"}}) {
    const auto result = run_fracfit(map(more));
    EXPECT_EQ(result.code, 2) << part;
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  }
}

}  // namespace
