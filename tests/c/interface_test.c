/* SPDX-License-Identifier: BSD-3-Clause */
/* The functions of fracfit.h in C99, against closed forms.  Ends with the number of what has failed. */
#include <complex.h>
#include <fracfit.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures = 0;

static void expect(int holds, const char* what, int line) {
  if (holds) return;
  ++failures;
  fprintf(stderr, "line %d: %s; fracfit_error() says \"%s\"\n", line, what, fracfit_error());
}
#define EXPECT(condition) expect(condition, #condition, __LINE__)
#define EXPECT_NEAR(a, b, tolerance) expect(fabs((a) - (b)) <= (tolerance), #a " is near " #b, __LINE__)
#define EXPECT_ERROR(part) expect(strstr(fracfit_error(), part) != NULL, "the sentence has " part, __LINE__)

enum { points = 60 };

/* K exp(-L s)/(T s^a + 1) with the library of C. */
static double complex lag(double K, double L, double T, double a, double omega) {
  const double complex s = I * omega;
  return K * cexp(-L * s) / (T * cpow(s, a) + 1);
}

static double omega_of(int i) {
  return 0.01 * pow(10.0, 4.0 * i / (points - 1));
}

static void test_model(void) {
  fracfit_model* model = fracfit_model_create("K exp(-L s)/(T s^a + 1)");
  EXPECT(model != NULL && fracfit_error()[0] == 0);
  EXPECT(fracfit_model_parameter_count(model) == 4);
  EXPECT(strcmp(fracfit_model_parameter_name(model, 1), "L") == 0 && fracfit_model_parameter_name(model, 4) == NULL);
  const double parameters[] = {2, 0.1, 0.5, 0.7};
  double omega[points], re[points], im[points];
  for (int i = 0; i < points; ++i) omega[i] = omega_of(i);
  EXPECT(fracfit_model_response(model, parameters, 4, omega, points, re, im) == FRACFIT_OK);
  for (int i = 0; i < points; ++i) {
    const double complex exact = lag(2, 0.1, 0.5, 0.7, omega[i]);
    /* Both round their functions to a few units in the last place; the phase of the dead time is up to 10 rad. */
    EXPECT(cabs(re[i] + I * im[i] - exact) <= 1e-14 * cabs(exact));
  }
  EXPECT(fracfit_model_response(model, parameters, 3, omega, points, re, im) == FRACFIT_WRONG_USE);
  EXPECT_ERROR("4");
  const double negative = -1;
  EXPECT(fracfit_model_response(model, parameters, 4, &negative, 1, re, im) == FRACFIT_WRONG_USE);
  EXPECT_ERROR("-1");
  EXPECT(fracfit_model_response(model, parameters, 4, omega, points, NULL, im) == FRACFIT_WRONG_USE);
  EXPECT_ERROR("re is NULL");
  EXPECT(fracfit_model_response(model, parameters, 4, NULL, 0, NULL, NULL) == FRACFIT_OK && fracfit_error()[0] == 0);
  fracfit_model_destroy(model);

  EXPECT(fracfit_model_create("K/(T s^a + ") == NULL);
  EXPECT_ERROR("^"); /* the caret under the place */
  EXPECT(fracfit_model_create(NULL) == NULL);
  EXPECT_ERROR("formula is NULL");
  EXPECT(fracfit_model_response(NULL, parameters, 4, omega, points, re, im) == FRACFIT_WRONG_USE);
  EXPECT(fracfit_model_parameter_count(NULL) == 0);
  fracfit_model_destroy(NULL);
}

static void test_step(void) {
  fracfit_model* model = fracfit_model_create("K exp(-L s)/(T s + 1)");
  const double parameters[] = {3, 0.5, 2};
  const double time[] = {4, 0.2, 0.5, 1, 100};
  double output[5];
  EXPECT(fracfit_model_step(model, parameters, 3, time, 5, output) == FRACFIT_OK);
  for (int i = 0; i < 5; ++i) {
    const double since = time[i] - 0.5;
    /* The method is exact to rounding: some 50 units of it. */
    EXPECT_NEAR(output[i], since > 0 ? -3 * expm1(-since / 2) : 0, 3e-14);
  }
  const double before = -1;
  EXPECT(fracfit_model_step(model, parameters, 3, &before, 1, output) == FRACFIT_WRONG_USE);
  EXPECT_ERROR("-1");
  fracfit_model_destroy(model);
  model = fracfit_model_create("s^0.5");
  const double start = 0;
  EXPECT(fracfit_model_step(model, NULL, 0, &start, 1, output) == FRACFIT_NO_RESULT && fracfit_error()[0] != 0);
  fracfit_model_destroy(model);
  model = fracfit_model_create("tanh(s)");
  EXPECT(fracfit_model_step(model, NULL, 0, time, 5, output) == FRACFIT_WRONG_USE && fracfit_error()[0] != 0);
  fracfit_model_destroy(model);
}

/* Standard normal by twelve uniform numbers. */
static double noise(void) {
  static unsigned long state = 12345;
  double sum = -6;
  for (int i = 0; i < 12; ++i) {
    state = (state * 1103515245UL + 12345UL) & 0x7fffffffUL;
    sum += (double)state / 2147483648.0;
  }
  return sum;
}

static void test_fit(void) {
  const double truth[] = {2, 0.5, 0.7}, level = 0.002;
  double omega[points], re[points], im[points], noisy_re[points], noisy_im[points], sigma[points];
  for (int i = 0; i < points; ++i) {
    omega[i] = omega_of(i);
    const double complex value = lag(2, 0, 0.5, 0.7, omega[i]);
    re[i] = creal(value), im[i] = cimag(value);
    noisy_re[i] = re[i] + level * noise(), noisy_im[i] = im[i] + level * noise(), sigma[i] = level;
  }
  fracfit_model* model = fracfit_model_create("K/(T s^a + 1)");
  fracfit_fit* fit = fracfit_fit_create(model, omega, re, im, NULL, points, NULL);
  EXPECT(fit != NULL && fracfit_fit_usable(fit) == 1 && fracfit_fit_parameter_count(fit) == 3);
  double value, error, lower, upper;
  for (size_t i = 0; i < 3; ++i) {
    EXPECT(fracfit_fit_parameter(fit, i, &value, NULL, NULL, NULL) == FRACFIT_OK);
    /* Data without noise: rounding, of which the search leaves the square root at most. */
    EXPECT_NEAR(value, truth[i], 1e-8 * truth[i]);
    EXPECT(strcmp(fracfit_fit_parameter_name(fit, i), fracfit_model_parameter_name(model, i)) == 0);
  }
  EXPECT(strstr(fracfit_fit_summary(fit), "K/(T s^a + 1)") != NULL);
  EXPECT(fracfit_fit_parameter(fit, 3, &value, NULL, NULL, NULL) == FRACFIT_WRONG_USE);
  EXPECT_ERROR("3");
  fracfit_fit_destroy(fit);

  fit = fracfit_fit_create(model, omega, noisy_re, noisy_im, sigma, points, NULL);
  EXPECT(fracfit_fit_usable(fit) == 1);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT(fracfit_fit_parameter(fit, i, &value, &error, &lower, &upper) == FRACFIT_OK);
    EXPECT(lower < value && value < upper && error > 0);
    /* Beyond five standard errors lies an estimate in two millions. */
    EXPECT_NEAR(value, truth[i], 5 * error);
    /* Student's t at 97.5 % is 1.98 for 117 degrees of freedom, and larger where correlation takes some of them. */
    EXPECT(upper - lower > 2 * 1.95 * error && upper - lower < 2 * 2.3 * error);
  }
  /* With the true deviation as weight the residuals have the spread 1, to five of its errors 1/sqrt(2 * 120). */
  EXPECT_NEAR(fracfit_fit_rms(fit), 1, 5 / sqrt(2.0 * 2 * points));
  EXPECT_NEAR(fracfit_fit_cost(fit), pow(fracfit_fit_rms(fit), 2) * 2 * points, 1e-9 * points);
  fracfit_fit_destroy(fit);

  fracfit_fit_options* options = fracfit_fit_options_create();
  EXPECT(fracfit_fit_options_choose(options, "component", "imaginary") == FRACFIT_OK);
  EXPECT(fracfit_fit_options_choose(options, "weight", "relative") == FRACFIT_OK);
  EXPECT(fracfit_fit_options_fix(options, "a", 0.7) == FRACFIT_OK);
  EXPECT(fracfit_fit_options_bound(options, "T", 0.6, 1) == FRACFIT_OK);
  EXPECT(fracfit_fit_options_start(options, "K", 1) == FRACFIT_OK);
  fit = fracfit_fit_create(model, omega, re, im, NULL, points, options);
  EXPECT(fracfit_fit_parameter(fit, 2, &value, &error, NULL, NULL) == FRACFIT_OK && value == 0.7 && error == 0);
  EXPECT(fracfit_fit_parameter(fit, 1, &value, &error, NULL, NULL) == FRACFIT_OK && isnan(error));
  EXPECT_NEAR(value, 0.6, 1e-6); /* held off from 0.5 by its limit */
  fracfit_fit_destroy(fit);
  EXPECT(fracfit_fit_options_choose(options, "weight", "heavy") == FRACFIT_WRONG_USE);
  EXPECT_ERROR("heavy");
  EXPECT(fracfit_fit_options_choose(options, "colour", "red") == FRACFIT_WRONG_USE);
  EXPECT_ERROR("component, weight and loss");
  EXPECT(fracfit_fit_options_fix(options, "q", 1) == FRACFIT_OK); /* known only once there is a model */
  EXPECT(fracfit_fit_create(model, omega, re, im, NULL, points, options) == NULL);
  EXPECT_ERROR("q");
  fracfit_fit_options_destroy(options);

  omega[3] = 0;
  EXPECT(fracfit_fit_create(model, omega, re, im, NULL, points, NULL) == NULL && fracfit_error()[0] != 0);
  EXPECT(fracfit_fit_create(model, omega, re, im, NULL, 0, NULL) == NULL && fracfit_error()[0] != 0);
  EXPECT(fracfit_fit_create(model, NULL, re, im, NULL, points, NULL) == NULL);
  EXPECT_ERROR("omega is NULL");
  EXPECT(isnan(fracfit_fit_rms(NULL)) && fracfit_fit_usable(NULL) == 0);
  fracfit_fit_destroy(NULL);
  fracfit_model_destroy(model);
}

static void test_pid(void) {
  fracfit_pid_settings* settings = fracfit_pid_settings_create();
  EXPECT(fracfit_pid_create(settings) == NULL); /* no sample time */
  EXPECT_ERROR("sample");
  EXPECT(fracfit_pid_settings_set(settings, "kp", 2) == FRACFIT_OK &&
         fracfit_pid_settings_set(settings, "ki", 3) == FRACFIT_OK);
  EXPECT(fracfit_pid_settings_set(settings, "sample_time", 0.01) == FRACFIT_OK);
  EXPECT(fracfit_pid_settings_set(settings, "maximum", 4) == FRACFIT_OK);
  EXPECT(fracfit_pid_settings_choose(settings, "anti_windup", "conditional-integration") == FRACFIT_OK);
  fracfit_pid* pid = fracfit_pid_create(settings);
  EXPECT(pid != NULL && fracfit_pid_note(pid)[0] == 0);
  for (int n = 1; n <= 60; ++n) {
    /* Trapezoidal rule from rest: the integral of 1 after n samples is (n - 1/2) T. */
    const double exact = 2 + 3 * 0.01 * (n - 0.5);
    EXPECT_NEAR(fracfit_pid_step(pid, 1.5, 0.5), exact, 1e-13);
    EXPECT(fracfit_pid_saturated(pid) == 0);
  }
  EXPECT(isfinite(fracfit_pid_step(pid, NAN, 0)) && fracfit_pid_refused(pid) == 1);
  EXPECT(fracfit_pid_step(pid, 100, 0) == 4 && fracfit_pid_saturated(pid) == 1 && fracfit_pid_refused(pid) == 0);
  fracfit_pid_track(pid, 1);
  EXPECT_NEAR(fracfit_pid_step(pid, 1, 1), 1, 1e-13);
  fracfit_pid_reset(pid, 0, 0);
  EXPECT_NEAR(fracfit_pid_step(pid, 1, 0), 2 + 3 * 0.005, 1e-13);
  fracfit_pid_destroy(pid);

  EXPECT(fracfit_pid_settings_set(settings, "kp", 0) == FRACFIT_OK &&
         fracfit_pid_settings_set(settings, "ki", 1) == FRACFIT_OK);
  EXPECT(fracfit_pid_settings_set(settings, "lambda", 0.5) == FRACFIT_OK);
  EXPECT(fracfit_pid_settings_set(settings, "band_lower", 1e-3) == FRACFIT_OK);
  EXPECT(fracfit_pid_settings_set(settings, "band_upper", 100) == FRACFIT_OK);
  EXPECT(fracfit_pid_settings_set(settings, "maximum", INFINITY) == FRACFIT_OK);
  pid = fracfit_pid_create(settings);
  EXPECT(pid != NULL && fracfit_pid_error(pid) < 2e-3);
  double output = 0;
  for (int n = 0; n < 1000; ++n) output = fracfit_pid_step(pid, 1, 0);
  /* The half integral of 1 at 10 s is sqrt(10)/Gamma(3/2), to the 1e-3 that the order is good to, and as much from
     where in its sample the step lies. */
  EXPECT_NEAR(output, sqrt(10) / tgamma(1.5), 2e-3 * sqrt(10) / tgamma(1.5));
  fracfit_pid_destroy(pid);

  EXPECT(fracfit_pid_settings_set(settings, "lambda", 3) == FRACFIT_OK);
  EXPECT(fracfit_pid_create(settings) == NULL && strstr(fracfit_error(), "3") != NULL);
  EXPECT(fracfit_pid_settings_set(settings, "gain", 1) == FRACFIT_WRONG_USE);
  EXPECT_ERROR("kp, ki, kd");
  EXPECT(fracfit_pid_settings_choose(settings, "anti_windup", "never") == FRACFIT_WRONG_USE);
  EXPECT_ERROR("never");
  fracfit_pid_settings_destroy(settings);
  EXPECT(isnan(fracfit_pid_step(NULL, 1, 0)));
  fracfit_pid_destroy(NULL);
}

int main(void) {
  EXPECT(fracfit_version()[0] >= '0' && fracfit_version()[0] <= '9');
  test_model();
  test_step();
  test_fit();
  test_pid();
  return failures;
}
