/* SPDX-License-Identifier: BSD-3-Clause */
/* A co-simulation as a simulator runs it: loads the library of a unit by the loader of the system, and knows nothing of
 * it but the standard.
 *
 * usage: fmu_importer LIBRARY 2|3 TOKEN INPUTS OUTPUT <STEPS
 * with the value references 0 to INPUTS - 1 of the inputs, that of the output, and in each line of STEPS the length of a
 * step and the inputs within it.  Prints the output after each step.
 */
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef _WIN32
#include <windows.h>
#define LOADED(path) ((void *)LoadLibraryA(path))
#define FOUND(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#else
#include <dlfcn.h>
#define LOADED(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define FOUND(library, name) dlsym(library, name)
#endif

static void *library;

static void *function(const char *name)
{
  void *found = FOUND(library, name);
  if (!found) {
    fprintf(stderr, "no function %s\n", name);
    exit(1);
  }
  return found;
}

static void require(int status, const char *what)
{
  if (status == 0) return;
  fprintf(stderr, "%s: status %d\n", what, status);
  exit(1);
}

static void say_2(void *environment, const char *name, int status, const char *category, const char *format, ...)
{
  va_list arguments;
  (void)environment;
  (void)name;
  (void)status;
  (void)category;
  va_start(arguments, format);
  vfprintf(stderr, format, arguments);
  va_end(arguments);
}

static void say_3(void *environment, int status, const char *category, const char *message)
{
  (void)environment;
  (void)status;
  (void)category;
  fprintf(stderr, "%s\n", message);
}

typedef struct {
  void (*logger)(void *, const char *, int, const char *, const char *, ...);
  void *(*allocate)(size_t, size_t);
  void (*release)(void *);
  void (*finished)(void *, int);
  void *environment;
} callbacks_of_2;

typedef void *instantiate_2(const char *, int, const char *, const char *, const callbacks_of_2 *, int, int);
typedef void *instantiate_3(const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t *, size_t,
                            void *, void (*)(void *, int, const char *, const char *), void (*)(void));
typedef int of_instance(void *);
typedef void release_instance(void *);
typedef int set_up_2(void *, int, double, double, int, double);
typedef int enter_3(void *, bool, double, double, bool, double);
typedef int set_2(void *, const uint32_t *, size_t, const double *);
typedef int set_3(void *, const uint32_t *, size_t, const double *, size_t);
typedef int get_2(void *, const uint32_t *, size_t, double *);
typedef int get_3(void *, const uint32_t *, size_t, double *, size_t);
typedef int step_2(void *, double, double, int);
typedef int step_3(void *, double, double, bool, bool *, bool *, bool *, double *);

int main(int count, char **argument)
{
  static const callbacks_of_2 callbacks = {say_2, calloc, free, 0, 0};
  static const uint32_t references[] = {0, 1};
  double time = 0, duration, input[2], output, reached;
  bool needs_event, is_ended, is_early;
  void *c;
  int inputs, i;
  uint32_t result;
  if (count != 6) return 2;
  library = LOADED(argument[1]);
  if (!library) {
    fprintf(stderr, "%s cannot be loaded\n", argument[1]);
    return 1;
  }
  inputs = atoi(argument[4]);
  result = (uint32_t)atoi(argument[5]);
  if (argument[2][0] == '3') {
    c = ((instantiate_3 *)function("fmi3InstantiateCoSimulation"))("name", argument[3], 0, false, true, false, false, 0,
                                                                   0, 0, say_3, 0);
    if (!c) return 1;
    require(((enter_3 *)function("fmi3EnterInitializationMode"))(c, false, 0, 0, false, 0), "enter");
    require(((of_instance *)function("fmi3ExitInitializationMode"))(c), "exit");
  } else {
    c = ((instantiate_2 *)function("fmi2Instantiate"))("name", 1, argument[3], "", &callbacks, 0, 1);
    if (!c) return 1;
    require(((set_up_2 *)function("fmi2SetupExperiment"))(c, 0, 0, 0, 0, 0), "set up");
    require(((of_instance *)function("fmi2EnterInitializationMode"))(c), "enter");
    require(((of_instance *)function("fmi2ExitInitializationMode"))(c), "exit");
  }
  while (scanf("%lf", &duration) == 1) {
    for (i = 0; i < inputs; ++i) {
      if (scanf("%lf", &input[i]) != 1) return 2;
    }
    if (argument[2][0] == '3') {
      require(((set_3 *)function("fmi3SetFloat64"))(c, references, (size_t)inputs, input, (size_t)inputs), "set");
      require(((step_3 *)function("fmi3DoStep"))(c, time, duration, true, &needs_event, &is_ended, &is_early, &reached),
              "step");
      if (needs_event || is_ended || is_early || reached != time + duration) return 1;
      require(((get_3 *)function("fmi3GetFloat64"))(c, &result, 1, &output, 1), "get");
    } else {
      require(((set_2 *)function("fmi2SetReal"))(c, references, (size_t)inputs, input), "set");
      require(((step_2 *)function("fmi2DoStep"))(c, time, duration, 1), "step");
      require(((get_2 *)function("fmi2GetReal"))(c, &result, 1, &output), "get");
    }
    time += duration;
    printf("%.17g\n", output);
  }
  if (argument[2][0] == '3') {
    require(((of_instance *)function("fmi3Terminate"))(c), "terminate");
    ((release_instance *)function("fmi3FreeInstance"))(c);
  } else {
    require(((of_instance *)function("fmi2Terminate"))(c), "terminate");
    ((release_instance *)function("fmi2FreeInstance"))(c);
  }
  return 0;
}
