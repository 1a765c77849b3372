// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "backlash/describing_function.hpp"
#include "frac/identification/identify.hpp"
#include "frac/model/time_response_data.hpp"
#include "frac/parallel_for.hpp"
#include "io/frequency_response_file.hpp"
#include "report/field.hpp"
#include "report/scene.hpp"
#include "report/section.hpp"

namespace report {

/// The inputs of every chapter.
struct Work {
  Scene scene;
  int threads = 0;
  frac::Progress* progress = nullptr;

  [[nodiscard]] backlash::TwoMassSystem system() const {
    return {scene.mass1, scene.mass2, scene.clearance, scene.restitution};
  }
};

/// One family of curves over one grid.
struct Family {
  std::vector<std::string> labels;  // enhanced text for keys
  std::vector<backlash::DescribingFunctionSweep> sweeps;
};

/// All curves of figures 3 to 8.
struct Curves {
  Family nichols_forces;                    // figure 4
  Family bode;                              // figure 5, one curve
  Family restitutions, clearances, forces;  // figures 6, 7, 8
};

[[nodiscard]] Curves compute_curves(const Work& work);

struct Bands;        // bands.hpp
struct LoopPicture;  // loop_figures.hpp

/// What the report finds, in six sentences and three pictures; its sentences come last, see add_sentences().
[[nodiscard]] Section minute_section(const Work& work, const Bands& bands);
/// The sentences, each between the pictures it belongs to, with numbers that are facts of the chapters.
/// @param minute    of minute_section()
/// @param chapters  all of the report
void add_sentences(Section& minute, const Work& work, const Bands& bands, const std::vector<Section>& chapters);

[[nodiscard]] Section curves_section(const Work& work, const Curves& curves);
[[nodiscard]] Section slope_section(const Work& work, const Bands& bands);
/// Error against number of parameters, for each class of models.  Needs a clearance above 0.
[[nodiscard]] Section economy_section(const Work& work, const Bands& bands);
/// The law of -1/N: all curves as loss factor over dimensionless frequency.  Needs a clearance above 0.
[[nodiscard]] Section loss_factor_section(const Work& work, const Curves& curves);
[[nodiscard]] Section jump_section(const Work& work, const Curves& curves);
/// Regimes of the dimensionless scene; every scene is one point of this map.
[[nodiscard]] Section map_section(const Work& work);
/// All of a scene whose contacts take time: curves, kinds of motion with their energy balance, the law of -1/N, jumps.
[[nodiscard]] Section compliant_section(const Work& work);
/// A loop around the two masses with the controller (M1 + M2)(1 + s^0.5): needs a clearance above 0.
[[nodiscard]] LoopPicture example_loop(const Work& work);
/// Exact limit cycles beside those of the describing function.  Needs a clearance above 0.
[[nodiscard]] Section limit_cycles_section(const Work& work);
/// Needs a clearance above 0.
[[nodiscard]] Section orbit_section(const Work& work);
[[nodiscard]] Section speed_section(const Work& work);
/// Bode, Nyquist and Nichols diagrams and step response of one fractional model.
[[nodiscard]] Section model_section();
/// Work-precision diagram of the time-response methods.
[[nodiscard]] Section response_speed_section();
/// Approximations of s^0.5 on four decades, and what they do to an order that is fitted through them.
[[nodiscard]] Section approximation_section(const Work& work, const Bands& bands);
/// Fits to a measured frequency response.
/// @param name    of the file, for the reader
/// @param number  from 1, makes the names of figures and tables
/// @param asked   how to draw it
[[nodiscard]] Section data_section(const Work& work, const std::string& name, const io::FrequencyResponseFile& file,
                                   std::size_t number, Field asked);
/// Fits to samples of input and output over time; parameters as above.
/// @param notes  what was assumed of the file, a sentence each
[[nodiscard]] Section time_section(const Work& work, const std::string& name, const frac::TimeResponseData& data,
                                   const std::vector<std::string>& notes, std::size_t number);

}  // namespace report
