// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/describe.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/identification/bodies_identification.hpp"
#include "backlash/identification/scene_comparison.hpp"
#include "backlash/loops/describe.hpp"
#include "commands/subcommand.hpp"
#include "frac/identification/derived.hpp"
#include "frac/identification/describe.hpp"
#include "frac/identification/economy.hpp"
#include "frac/identification/identify.hpp"
#include "frac/identification/joint_fit.hpp"
#include "output/document.hpp"
#include "output/limit_cycles_output.hpp"

namespace fracfit {
namespace {

struct DescribedResult {
  std::string_view name;
  std::vector<frac::NumberDescription> (*numbers)(bool flat);
};

// By the names that the meanings refer to.
constexpr std::array results{
    DescribedResult{"fit", frac::described_numbers<frac::FitResult>},
    DescribedResult{"parameter", frac::described_numbers<frac::ParameterEstimate>},
    DescribedResult{"prior", frac::described_numbers<frac::PriorEstimate>},
    DescribedResult{"derived", frac::described_numbers<frac::DerivedEstimate>},
    DescribedResult{"lack-of-fit", frac::described_numbers<frac::LackOfFit>},
    DescribedResult{"identification", frac::described_numbers<frac::IdentificationResult>},
    DescribedResult{"candidate", frac::described_numbers<frac::RankedFit>},
    DescribedResult{"finalist", frac::described_numbers<frac::Finalist>},
    DescribedResult{"distribution", frac::described_numbers<frac::DistributionRival>},
    DescribedResult{"next-measurement", frac::described_numbers<frac::NextMeasurement>},
    DescribedResult{"joint-fit", frac::described_numbers<frac::JointFitResult>},
    DescribedResult{"joint-curve", frac::described_numbers<frac::JointCurveResult>},
    DescribedResult{"economy", frac::described_numbers<frac::Economy>},
    DescribedResult{"economy-curve", frac::described_numbers<frac::EconomyCurve>},
    DescribedResult{"economy-point", frac::described_numbers<frac::EconomyPoint>},
    DescribedResult{"scene", frac::described_numbers<backlash::SceneIdentification>},
    DescribedResult{"scene-estimate", frac::described_numbers<backlash::SceneEstimate>},
    DescribedResult{"scene-point", frac::described_numbers<backlash::ScenePoint>},
    DescribedResult{"rival-scene", frac::described_numbers<backlash::RivalScene>},
    DescribedResult{"bodies", frac::described_numbers<backlash::BodiesIdentification>},
    DescribedResult{"comparison", frac::described_numbers<backlash::SceneComparison>},
    DescribedResult{"limit-cycle", described_limit_cycle},
    DescribedResult{"cycle-harmonic", frac::described_numbers<backlash::CycleHarmonic>},
    DescribedResult{"cycle-impact", frac::described_numbers<backlash::CycleImpact>},
    DescribedResult{"cycle-rest", frac::described_numbers<backlash::CycleRest>},
    DescribedResult{"predicted-cycle", frac::described_numbers<backlash::PredictedCycle>},
    DescribedResult{"explanation", frac::described_numbers<backlash::ExplanationFit>},
};

class Describe : public Command {
 public:
  Describe() : Command("describe", "Names, units and meanings of the numbers in results") {
    std::vector<std::string> names;
    for (const auto& each : results) names.emplace_back(each.name);
    options()
        .text("--result", result_, "Result that is described", "RESULT")
        .one_of(names)
        .or_argument()
        .default_is("all");
    add_common({"csv", "json", "table"});
    set_footer(
        "The keys of JSON, as the Python module names them too; columns of CSV are some of them.  A number that is "
        "not\n"
        "there is null in JSON, nan elsewhere.  Units \"residual\", \"value\" and \"parameter\" are those of the "
        "weighted\n"
        "residuals, of the data and of the parameter.\n"
        "Examples:\n"
        "  fracfit describe fit\n"
        "  fracfit describe --format json");
  }

 private:
  int run() override {
    std::vector<std::pair<std::string, frac::NumberDescription>> rows;
    for (const auto& each : results)
      if (result_.empty() || result_ == each.name)
        for (auto& number : each.numbers(false)) rows.emplace_back(each.name, std::move(number));
    write(text_of({{},
                   {{"result", "key", "kind", "unit", "meaning"},
                    rows.size(),
                    [&](std::size_t i, std::vector<Cell>& cells) {
                      const auto& [result, number] = rows[i];
                      cells.insert(cells.end(), {result, number.key, number.kind, number.unit, number.meaning});
                    }}},
                  format(), command_line()));
    return usable_result;
  }

  std::string result_;
};

}  // namespace

std::unique_ptr<Command> make_describe() {
  return std::make_unique<Describe>();
}

}  // namespace fracfit
