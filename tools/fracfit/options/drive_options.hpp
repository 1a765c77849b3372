// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "options/options.hpp"

namespace fracfit {

/// Words of a rotating drive, for every option of two masses that is declared: inertias, torques, degrees, and the
/// ratio of a gear between motor and load.
/// @param texts  where what is given for them is kept
void add_drive_words(Options& options, std::string& texts);

/// Puts the options of two masses in the place of those words, as a drive seen from the shaft of the load: with the
/// motor turning n times as far, its inertia counts n^2 times and its torque n times, and a controller, which is of the
/// motor's torque and the angle measured, n times or n^2 times.  Positions are angles in rad.
/// @return a note on what the results mean; empty where no such word is given
/// @throws std::invalid_argument  a word beside the option that it stands for, a ratio of 0, or no number.
std::string convert_drive_words(Options& options);
/// A message with those words that were given in the place of the options that they stand for.
[[nodiscard]] std::string in_drive_words(const Options& options, const std::string& message);

/// A position controller around a speed controller, 'cascade(K1, K2, T)' or 'cascade(K1, K2)': the force
/// K2 (1 + 1/(T s)) (K1 (r - x) - s x).
struct Cascade {
  std::string position_gain, speed_gain, integral_time;  // the last is empty where there is no integral

  /// Empty where the text is none. @throws std::invalid_argument  another number of arguments.
  static std::optional<Cascade> of(std::string_view option, const std::string& text);
  /// (K1 + s) (K2 + K2/(T s)).
  [[nodiscard]] std::string formula() const;
  [[nodiscard]] std::string text() const;
};

}  // namespace fracfit
