// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/data_error.hpp"
#include "report/fixed_step_reference.hpp"
#include "report/scene.hpp"
#include "report/staged_folder.hpp"
#include "report/sweep_curves.hpp"
#include "temporary_folder.hpp"

namespace {

using namespace report;
namespace fs = std::filesystem;

// U at gamma = 0.3, eps = 0.6 from the closed form of the symmetric orbit in quadruple precision; N1 = -(1 +
// U/gamma)/(M1 + M2) at omega = 1.  The method is first order: a quarter of the step leaves a quarter of the error. The
// error of a single step size scatters by where the impact falls within its step, hence the wide bracket.
TEST(FixedStepReference, ConvergesToTheClosedFormWithFirstOrder) {
  const FixedStepScene scene{1, 1, 1, 0.6, 0.3};
  const std::complex<double> relative(0.27179811, -0.25733052);
  const std::complex<double> exact = -(1.0 + relative / 0.3) / 2.0;
  const auto error = [&](std::size_t steps) {
    return std::abs(fixed_step_describing_function(scene, 1, steps, 80, 20) - exact) / std::abs(exact);
  };
  const double coarse = error(512);
  const double fine = error(8192);
  EXPECT_LT(coarse, 0.03);
  const double order = std::log2(coarse / fine) / 4;
  EXPECT_NEAR(order, 1, 0.2);
}

TEST(PaperScene, HoldsTheFamiliesOfTheFigures) {
  const Scene scene = paper_scene();
  EXPECT_EQ(scene.forces, (std::vector<double>{10, 20, 30, 40, 50}));
  EXPECT_EQ(scene.clearances, (std::vector<double>{0, 0.1, 0.2, 0.3, 0.4, 0.5}));
  EXPECT_EQ(scene.restitutions, (std::vector<double>{0, 0.2, 0.4, 0.6, 0.8, 1}));
  EXPECT_EQ(scene.jump_clearances, (std::vector<double>{0.01, 0.025, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5}));
  EXPECT_EQ(scene.omega_bode.front(), 0.5);
  EXPECT_EQ(scene.omega_family.back(), 35);
}

TEST(ReadScene, TakesNumbersListsAndGrids) {
  const TemporaryFolder folder;
  const Scene scene = read_scene(folder.write(
      "scene.json", R"({"m1": 2, "clearance": [0, 0.2], "restitution": 0.5, "force": [10, 30], "omega": "1:9:5"})"));
  EXPECT_EQ(scene.mass1, 2);
  EXPECT_EQ(scene.mass2, 1);
  EXPECT_EQ(scene.clearance, 0.2);
  EXPECT_EQ(scene.jump_clearances, (std::vector<double>{0.2}));
  EXPECT_EQ(scene.force, 10);
  EXPECT_EQ(scene.omega_bode, (std::vector<double>{1, 3, 5, 7, 9}));
}

TEST(ReadScene, TakesTheMassesUnderTheNamesOfTheCommandLine) {
  const TemporaryFolder folder;
  const std::string rest = R"("clearance": 0.2, "restitution": 0.5, "force": 10, "omega": "1:9:5"})";
  const Scene scene = read_scene(folder.write("scene.json", R"({"mass1": 2, "mass2": 3, )" + rest));
  EXPECT_EQ(scene.mass1, 2);
  EXPECT_EQ(scene.mass2, 3);
  EXPECT_THROW(static_cast<void>(read_scene(folder.write("twice.json", R"({"mass1": 2, "m1": 2, )" + rest))),
               io::DataError);
}

TEST(ReadScene, NamesTheMemberThatIsWrong) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"({"clearance": 0.3, "restitution": 0.6, "omega": "1:9:5"})", "\"force\" is missing"},
      {R"({"clearance": -1, "restitution": 0.6, "force": 1, "omega": "1:9:5"})", "\"clearance\" holds -1"},
      {R"({"clearance": 1, "restitution": 1.5, "force": 1, "omega": "1:9:5"})", "\"restitution\" holds 1.5"},
      {R"({"clearance": 1, "restitution": "high", "force": 1, "omega": "1:9:5"})", "\"restitution\" holds \"high\""},
      {R"({"clearance": 1, "restitution": 1, "force": [], "omega": "1:9:5"})", "\"force\" is an empty list"},
      {R"({"clearance": 1, "restitution": 1, "force": [5, 5], "omega": "1:9:5"})", "\"force\" holds 5 twice"},
      {R"({"clearance": 1, "restitution": 1, "force": 1, "omega": [3, 2, 4, 5, 6]})", "\"omega\" holds 2 after 3"},
      {R"({"clearance": 1, "restitution": 1, "force": 1, "omega": [0, 2, 4, 5, 6]})", "\"omega\" holds 0"},
      {R"({"clearance": 1, "restitution": 1, "force": 1, "omega": [1, 2]})", "\"omega\" has 2 entries"},
      {R"({"clearance": 1, "restitution": 1, "force": 1, "omega": "1:9"})", "omega"},
      {R"({"clearance": 1, "restitution": 1, "force": 1, "omega": "1:9:5", "gap": 2})", "unknown member \"gap\""},
      {R"({"clearance": 1, "contact_stiffness": 100, "force": 1, "omega": "1:9:5"})",
       "a contact is given by \"contact_stiffness\"; expected contact_stiffness with contact_damping"},
      {R"({"clearance": 1, "contact_stiffness": 1, "contact_damping": 0, "force": 1, "omega": "1:9:5"})",
       "\"contact_damping\" holds 0; expected > 0"},
      {R"({"clearance": 0, "contact_stiffness": 1, "contact_damping": 1, "force": 1, "omega": "1:9:5"})",
       "\"clearance\" holds 0; expected > 0"},
      {R"({"clearance": 1, "restitution": 1, "contact_damping": 1, "force": 1, "omega": "1:9:5"})",
       "\"restitution\" and \"contact_damping\" are both given"},
      {R"({"clearance": 1, "contact_frequency": 1, "contact_restitution": 1, "force": 1, "omega": "1:9:5"})",
       "\"contact_restitution\" holds 1"},
      {R"({"clearance": 1, "restitution": 1, "friction1": 1, "force": 1, "omega": "1:9:5"})",
       "\"friction1\" needs contacts that take time"},
      {R"({"m1": [1, 2], "clearance": 1, "restitution": 1, "force": 1, "omega": "1:9:5"})", "\"m1\" is a list"},
      {R"([1, 2])", "expected an object"},
      {R"({"clearance": )", "scene.json:1:15: is not JSON: it ends too early"},
      {"{\"clearance\":\n  ?1}", "scene.json:2:3: is not JSON: cannot go on with '?'"},
  };
  const TemporaryFolder folder;
  for (const auto& [text, expected] : cases) {
    const std::string file = folder.write("scene.json", text);
    try {
      static_cast<void>(read_scene(file));
      ADD_FAILURE() << text;
    } catch (const io::DataError& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(static_cast<void>(read_scene(folder.path("missing.json"))), io::DataError);
}

TEST(StagedFolder, LeavesNothingBehindUnlessPublished) {
  const TemporaryFolder folder;
  {
    const StagedFolder staged(folder.path("new/report"));
    staged.write("tables/a.csv", "a\n1\n");
  }
  EXPECT_FALSE(fs::exists(folder.path("new/report")));
}

TEST(StagedFolder, PublishesFilesAndKeepsWhatElseIsThere) {
  const TemporaryFolder folder;
  folder.write("notes.txt", "mine");
  folder.write("index.html", "old");
  StagedFolder staged(folder.path());
  staged.write("tables/a.csv", "a\n1\n");
  staged.write("index.html", "new");
  EXPECT_EQ(content_of(folder.path("index.html")), "old");
  staged.publish("index.html");
  EXPECT_EQ(content_of(folder.path("index.html")), "new");
  EXPECT_EQ(content_of(folder.path("tables/a.csv")), "a\n1\n");
  EXPECT_EQ(content_of(folder.path("notes.txt")), "mine");
}

TEST(StagedFolder, RefusesAFileInPlaceOfTheFolder) {
  const TemporaryFolder folder;
  const std::string file = folder.write("report", "");
  EXPECT_THROW(StagedFolder(fs::path(file)), std::invalid_argument);
  EXPECT_THROW(StagedFolder(fs::path(file) / "below"), std::invalid_argument);
}

backlash::DescribingFunctionPoint point(double omega, backlash::Regime regime, int period, double impacts) {
  return {omega, {-1 / omega, 0.1}, regime, period, impacts, 0.01, 0};
}

TEST(SweepCurves, NeverJoinAcrossAJumpOrToALongTimeMean) {
  using backlash::Regime;
  const backlash::TwoMassSystem system(1, 1, 0.3, 0.6);
  const backlash::DescribingFunctionSweep sweep{
      system,
      40,
      {},
      {point(1, Regime::chatter, 1, INFINITY), point(2, Regime::chatter, 1, INFINITY),
       point(3, Regime::averaged, 0, 3.2), point(4, Regime::periodic, 1, 3), point(5, Regime::periodic, 1, 2),
       point(6, Regime::symmetric, 1, 2)}};
  const auto curves = sweep_curves(sweep, "label", "#000000", [](const auto& p) {
    return std::optional<PlotPoint>(
        {p.omega, p.value.real(), p.value.real() - p.uncertainty, p.value.real() + p.uncertainty});
  });
  std::map<Mark, std::vector<std::size_t>> lengths;
  for (const Curve& curve : curves) {
    for (const auto& segment : curve.segments) lengths[curve.mark].push_back(segment.size());
  }
  EXPECT_EQ(lengths[Mark::line], (std::vector<std::size_t>{2, 2}));
  EXPECT_EQ(lengths[Mark::points], (std::vector<std::size_t>{1}));
  EXPECT_EQ(lengths[Mark::faint_points], (std::vector<std::size_t>{1}));
}

}  // namespace
