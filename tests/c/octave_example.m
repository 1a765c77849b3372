% SPDX-License-Identifier: BSD-3-Clause
% The response of a formula from Octave, held against Octave's own powers.
omega = logspace(-2, 2, 50);
[re, im] = fracfit_response("K exp(-L s)/(T s^a + 1)", [2 0.1 0.5 0.7], omega);
s = 1i*omega;
exact = 2*exp(-0.1*s)./(0.5*s.^0.7 + 1);
% Both round a few times; the phase of the dead time is up to 10 rad.
assert(all(abs(re + 1i*im - exact) <= 1e-14*abs(exact)));
try
  [re, im] = fracfit_response("K/(T s^a +", [2 0.5 0.7], omega);
  assert(false);
catch problem
  assert(! isempty(strfind(problem.message, "operand is missing")));
end
disp("response to within 1e-14");
