// SPDX-License-Identifier: BSD-3-Clause
// Example sketch of an Arduino library with a filter.

/* Filters what is read at INPUT_PIN every SAMPLE_MICROSECONDS microseconds and prints it. */
#include <NAME.h>

#define INPUT_PIN A0
static const REAL input_per_count = REAL(5) / 1023;

static NAME_state state;
static unsigned long next_time;

void setup()
{
  Serial.begin(115200);
  NAME_init(&state);
  next_time = micros();
}

void loop()
{
  /* The difference of two times is right even where micros() has begun anew. */
  if ((long)(micros() - next_time) < 0) return;
  next_time += SAMPLE_MICROSECONDS;
  Serial.println(NAME_step(&state, (REAL)analogRead(INPUT_PIN) * input_per_count), 6);
}
