// SPDX-License-Identifier: BSD-3-Clause
#include "options/vocabulary.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace fracfit {

const Meaning& meaning_of(std::string_view name) {
  static const std::vector<Meaning> vocabulary{
      // Two masses with backlash.
      {"--force", "F", "Force amplitude on mass 2, N, > 0"},
      {"--clearance", "DELTA", "Clearance, m"},
      {"--restitution", "EPS", "Coefficient of restitution, 0 to 1"},
      {"--contact-stiffness", "K", "Stiffness of contacts instead of a restitution, N/m, > 0"},
      {"--contact-damping", "C", "Their damping, N s/m: they press max(0, K d + C d') at the overlap d"},
      {"--contact-frequency", "WC", "Contacts by sqrt(K/m), rad/s, m = M1 M2/(M1 + M2)"},
      {"--contact-ratio", "ZETA", "With it, C/(2 sqrt(K m))"},
      {"--contact-restitution", "EPS", "Or ZETA by the restitution of a free contact, in (0, 1]"},
      {"--friction1", "FC1", "Dry friction on mass 1, N"},
      {"--friction2", "FC2", "Dry friction on mass 2, N"},
      {"--mass1", "M1", "Mass 1, kg"},
      {"--mass2", "M2", "Mass 2, kg"},
      {"--inertia1", "J1", "Of a rotating drive instead of --mass1: inertia of the load, kg m^2"},
      {"--inertia2", "J2", "Instead of --mass2: inertia of the motor, at its own shaft, kg m^2"},
      {"--torque", "T", "Instead of --force: torque amplitude of the motor, N m"},
      {"--torque-limit", "T", "Instead of --force-limit: largest torque of the motor, N m"},
      {"--gap-degrees", "GAP", "Instead of --clearance: at the shaft of the load, degrees"},
      {"--friction-torque1", "T", "Instead of --friction1: of the load, N m"},
      {"--friction-torque2", "T", "Instead of --friction2: of the motor, N m"},
      {"--load-torque", "T", "Instead of --disturbance1: constant torque on the load, N m"},
      {"--step-degrees", "R", "Instead of --setpoint-step: at the shaft of the load, degrees"},
      {"--gear-ratio", "N", "Turns of the motor per turn of the load, with such words of a drive"},
      {"--omega", "W", "Angular frequency, rad/s"},
      {"--body", "BODY", "Mass whose position is read"},
      {"--quantity", "NAME", "What the values are"},
      {"--protocol", "P", "Where the motion starts"},
      {"--orbit-tolerance", "T", "Closure of an orbit, relative to the clearance"},
      {"--position", "Y", "x2 - x1 where the force is at its peak, m: 0 at one wall, the clearance at the other"},
      {"--velocity", "V", "x2' - x1' there, m/s"},
      {"--criterion", "C", "What counts as the jump"},
      // Records as a rig writes them.
      {"--sensor-noise", "S", "Standard deviation of white noise on positions, m"},
      {"--force-noise", "S", "Standard deviation of white noise on the force, N"},
      {"--quantisation", "Q", "Step of the converter of positions, m; 0: none"},
      {"--clip", "X", "Largest absolute position that is read, m"},
      {"--sensor-delay", "T", "Positions are read so late, s"},
      {"--input-file", "FILE", "File that holds the input"},
      {"--clock-jitter", "T", "Standard deviation of the instants of samples, s, up to a tenth of their distance"},
      // Models and approximations.
      {"--model", "MODEL", "Formula of s, e.g. '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)'"},
      {"--band", "LOW:HIGH", "Frequency band, rad/s"},
      {"--tolerance", "T", "Largest relative error allowed"},
      {"--poles", "N", "Number of poles per power of s"},
      {"--sample-time", "TS", "Time between samples, s"},
      {"--method", "METHOD", "How it is computed"},
      {"--discretisation", "METHOD", "How the recursion in the samples is made"},
      {"--hold", "HOLD", "How the input runs between samples"},
      {"--lambda", "ORDER", "Order of integration"},
      {"--mu", "ORDER", "Order of differentiation"},
      {"--name", "NAME", "What the exported text is called"},
      {"--precision", "REAL", "Arithmetic"},
      {"--fmi", "VERSION", "Functional Mock-up Interface"},
      {"--windows", "", "For 64-bit Windows"},
      {"--derivative-filter", "T", "Time constant of the lag before the derivative, s"},
      // Fitting.
      {"--models", "LIST", "Presets or formulas to rank, separated by commas"},
      {"--component", "PART", "Part of the response that is fitted"},
      {"--fit", "FILE", "Result of fracfit fit as JSON: its model, parameters and their covariance"},
      {"--print", "WORDS",
       "Print the two masses alone, in these words: options of this program, a model of Modelica or of MuJoCo"},
      {"--friction", "FRICTION", "Whether masses have dry friction"},
      {"--contact", "CONTACT", "Whether contacts are hard (take no time) or have stiffness and damping"},
      {"--weight", "WEIGHT", "What residuals are divided by"},
      {"--noise", "NOISE", "Of samples over time: white, or coloured (of first order, its correlation estimated)"},
      {"--fix", "NAME=VALUE", "Hold a parameter at a value; repeatable"},
      {"--bound", "NAME=LOW:HIGH", "Limits of a parameter, one side may be left out; repeatable"},
      {"--start", "NAME=VALUE", "Start a parameter at a value; repeatable"},
      {"--prior", "PRIOR",
       "What is known of a parameter beside the data, as a normal distribution NAME=VALUE+-DEVIATION, or "
       "NAME=VALUE+-SHARE% of its logarithm; repeatable"},
      {"--constraint", "ORDER", "Parameters of one kind in rising order, e.g. 'Q1<Q2'; repeatable"},
      {"--derive", "DEFINITION",
       "Quantity computed from the parameters, with its interval, e.g. 'f1 = (R1 Q1)^(-1/n1)/(2 pi)'; repeatable"},
      {"--stable", "yes|no", "Whether the system is taken to have no pole right of the imaginary axis"},
      {"--dead-time", "yes|no", "Whether the system has a dead time"},
      {"--passive", "", "The data are an immittance of a passive system, whose real part is nowhere negative"},
      {"--where", "TEST", "Use only points that satisfy a comparison with a number; repeatable"},
      {"--seed", "N", "Seed of random numbers; same seed, same result"},
      // Every command.
      {"--shard", "i/n",
       "Work on every n-th piece only, from the i-th; auto or auto/n: as a batch system or MPI launcher says; {shard} "
       "in "
       "--out stands for it; join with fracfit merge"},
      {"--out", "FILE", "Output file"},
      {"--format", "FORMAT", "Output format"},
      {"--progress", "FORM", "Progress on standard error: a bar on a terminal, or a line of JSON each second"},
      {"--time-limit", "SECONDS", "Ends without a result after so many seconds, a second later at most"},
      {"--threads", "N", "Threads, 0 for one per core; results do not depend on it"},
  };
  const auto found =
      std::find_if(vocabulary.begin(), vocabulary.end(), [&](const Meaning& meaning) { return meaning.name == name; });
  if (found == vocabulary.end()) throw std::logic_error("no meaning of " + std::string(name) + " is known");
  return *found;
}

}  // namespace fracfit
