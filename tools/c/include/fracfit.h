/* SPDX-License-Identifier: BSD-3-Clause */
/* fracfit for C, and for every language that calls C: models given as formulas of s, their responses, their fits to
   measured frequency responses with intervals, and the fractional PID.

   Functions that can fail return a status, or a handle that is NULL where they did; fracfit_error() then has one
   sentence that names the quantity, its value and what is allowed.  Nothing is thrown and nothing is printed.  A handle
   is what its _create function has returned; it is given back to the _destroy function of the same name once, which
   takes NULL too.  Functions that only read a handle may be called from several threads at once.  Texts that are
   returned live as long as their handle.

   Angular frequencies are in rad/s, times in s; arrays hold `count` numbers. */
#ifndef FRACFIT_H
#define FRACFIT_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a call has come to: the exit codes of the program fracfit. */
enum fracfit_status {
  FRACFIT_OK = 0,        /* done */
  FRACFIT_NO_RESULT = 1, /* computed, but there is no usable result */
  FRACFIT_WRONG_USE = 2, /* an argument is not allowed */
  FRACFIT_FAILED = 4     /* out of memory, or a fault of fracfit */
};

/* Why the last call of this thread that can fail did so, "" where it did not.  Lives until the next such call. */
const char* fracfit_error(void);
/* Such as "0.3.0"; with -dev between two releases. */
const char* fracfit_version(void);

/* --- A model: a formula of s with named parameters, such as "K exp(-L s)/(T s^a + 1)". --- */

typedef struct fracfit_model fracfit_model;

/* NULL where the text is no formula; the sentence then has the place. */
fracfit_model* fracfit_model_create(const char* formula);
void fracfit_model_destroy(fracfit_model* model);
/* Parameters stand in the order in which the formula names them. */
size_t fracfit_model_parameter_count(const fracfit_model* model);
/* NULL beyond the last one. */
const char* fracfit_model_parameter_name(const fracfit_model* model, size_t index);
/* G(j omega) in its real and imaginary part.  `parameters` holds one value for each parameter; it may be NULL where
   there is none. omega > 0, in any order.  Where the model has a pole the value is not finite. */
int fracfit_model_response(const fracfit_model* model, const double* parameters, size_t parameter_count,
                           const double* omega, size_t count, double* re, double* im);
/* Answer to a unit step at t = 0 from rest, exact to rounding, at times t >= 0 in any order.  The model has to be a
   ratio of sums of powers of s, with a dead time or none.  FRACFIT_NO_RESULT where the answer is infinite at one of the
   times, or where two methods do not agree on it; the numbers are there all the same. */
int fracfit_model_step(const fracfit_model* model, const double* parameters, size_t parameter_count, const double* time,
                       size_t count, double* output);

/* --- A fit of a model to a measured frequency response. --- */

typedef struct fracfit_fit_options fracfit_fit_options;

/* As the command `fit` does unless told otherwise: both components, the weight learned from the data, parameters free.
 */
fracfit_fit_options* fracfit_fit_options_create(void);
void fracfit_fit_options_destroy(fracfit_fit_options* options);
/* A choice by its word on the command line: "component" (both, imaginary, real, magnitude, phase), "weight" (learned,
   relative, absolute, given, ...), "loss" (none, huber, cauchy). */
int fracfit_fit_options_choose(fracfit_fit_options* options, const char* name, const char* word);
/* A parameter that is known; between limits, of which either may be infinite; where its search begins. */
int fracfit_fit_options_fix(fracfit_fit_options* options, const char* parameter, double value);
int fracfit_fit_options_bound(fracfit_fit_options* options, const char* parameter, double lower, double upper);
int fracfit_fit_options_start(fracfit_fit_options* options, const char* parameter, double value);

typedef struct fracfit_fit fracfit_fit;

/* Fits without start values; takes milliseconds to seconds.  omega > 0 does not fall from point to point, equal ones
   are repeats. sigma, the standard deviation of re and of im, may be NULL; where it is given it is the weight, unless
   `options` choose another. `options` may be NULL.  NULL where the data or the options are not allowed. */
fracfit_fit* fracfit_fit_create(const fracfit_model* model, const double* omega, const double* re, const double* im,
                                const double* sigma, size_t count, const fracfit_fit_options* options);
void fracfit_fit_destroy(fracfit_fit* fit);
/* 1 where the search has converged, else 0. */
int fracfit_fit_usable(const fracfit_fit* fit);
/* A few lines for a person: parameters, intervals, what became of the search. */
const char* fracfit_fit_summary(const fracfit_fit* fit);
size_t fracfit_fit_parameter_count(const fracfit_fit* fit);
const char* fracfit_fit_parameter_name(const fracfit_fit* fit, size_t index);
/* The estimate, its standard error and its 95 % interval; each place may be NULL.  The last three are NaN for a
   parameter that the data do not tell or that ended at a limit; one that is fixed has an error of 0. */
int fracfit_fit_parameter(const fracfit_fit* fit, size_t index, double* value, double* standard_error,
                          double* ci95_lower, double* ci95_upper);
/* Root mean square of the weighted residuals; the sum of their squares. */
double fracfit_fit_rms(const fracfit_fit* fit);
double fracfit_fit_cost(const fracfit_fit* fit);

/* --- A fractional PID: u = kp (b r - y) + ki s^-lambda (r - y) + kd s^mu/(1 + Tf s) (c r - y). --- */

typedef struct fracfit_pid_settings fracfit_pid_settings;

/* kp = 1, ki = kd = 0, lambda = mu = 1, no limits of the output. */
fracfit_pid_settings* fracfit_pid_settings_create(void);
void fracfit_pid_settings_destroy(fracfit_pid_settings* settings);
/* "kp", "ki", "kd", "lambda", "mu"; "sample_time", s, which is always needed; "band_lower" and "band_upper", rad/s, on
   which the orders hold, not needed where they are 1; "tolerance", the largest relative error there (0.001); "minimum"
   and "maximum" of the output; "tracking_time" and "derivative_filter_time" (Tf), s; "setpoint_weight" (b) and
   "derivative_setpoint_weight" (c). */
int fracfit_pid_settings_set(fracfit_pid_settings* settings, const char* name, double value);
/* "anti_windup" (none, back-calculation, conditional-integration), "discretisation" (direct, tustin, ...). */
int fracfit_pid_settings_choose(fracfit_pid_settings* settings, const char* name, const char* word);

typedef struct fracfit_pid fracfit_pid;

/* The controller at rest; designing it takes milliseconds.  NULL where the settings cannot be built. */
fracfit_pid* fracfit_pid_create(const fracfit_pid_settings* settings);
void fracfit_pid_destroy(fracfit_pid* pid);
/* What differs from what was asked, such as a tolerance that is not kept; "" where nothing does. */
const char* fracfit_pid_note(const fracfit_pid* pid);
/* Largest relative error of the running controller on the band; NaN without a band. */
double fracfit_pid_error(const fracfit_pid* pid);
/* Output for the next sample, in constant time and without allocating.  Inputs that are not finite are refused: the
   last output stands, and fracfit_pid_refused() is 1 until the next call.  NaN where pid is NULL. */
double fracfit_pid_step(fracfit_pid* pid, double setpoint, double measured);
/* The next output is this one: called before each step while something else drives the plant, so that the takeover is
 * smooth. */
void fracfit_pid_track(fracfit_pid* pid, double output);
/* To rest, after signals that were constant at these values. */
void fracfit_pid_reset(fracfit_pid* pid, double setpoint, double measured);
/* 1 where the last output was cut at a limit; where the last inputs were refused. */
int fracfit_pid_saturated(const fracfit_pid* pid);
int fracfit_pid_refused(const fracfit_pid* pid);

#ifdef __cplusplus
}
#endif

#endif
