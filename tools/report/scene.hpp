// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"

namespace report {

/// What the report computes: families of curves about one base scene.
struct Scene {
  bool of_the_paper = false;
  double mass1, mass2;                   // kg
  double force, clearance, restitution;  // N, m, 1: the base scene, held while another quantity runs through its family
  std::vector<double> forces, clearances, restitutions;  // families
  std::optional<backlash::CompliantContact> contact;     // that takes time; restitution is then that of a free contact
  backlash::CoulombFriction friction;                    // with it
  std::vector<double> omega_nichols, omega_bode, omega_family;          // rad/s
  std::vector<double> jump_forces, jump_clearances, jump_restitutions;  // grid of the jump laws
};

/// The base scene in HTML, "F = 40 N, Δ = 0.3 m, ε = 0.6", with the quantities that are asked for.
[[nodiscard]] std::string base_scene_text(const Scene& scene, bool force = true, bool clearance = true,
                                          bool restitution = true);

/// The caption of a figure, which begins with its number in the paper where the scene is the paper's.
[[nodiscard]] std::string numbered_caption(const Scene& scene, int number, const std::string& caption);

/// The scenes of figures 3 to 10 in Duarte, Tenreiro Machado (2009).
[[nodiscard]] Scene paper_scene();

/// Reads {"mass1": 1, "mass2": 1, "clearance": [0.1, 0.3], "restitution": 0.6, "force": [20, 40], "omega":
/// "5:35:200log"}. mass1 and mass2 (also m1 and m2) may be left out (1 kg); clearance, restitution and force are a
/// number or a list, whose first entry (first positive clearance) belongs to the base scene; omega is a list or a grid
/// as on the command line.  In place of restitution contact_stiffness and contact_damping, or contact_frequency and
/// contact_ratio or contact_restitution, one number each, with friction1 and friction2, 0 if left out.
/// @throws io::DataError  not readable, not JSON, or a member missing, unknown, of the wrong kind or out of range.
[[nodiscard]] Scene read_scene(const std::filesystem::path& file);

}  // namespace report
