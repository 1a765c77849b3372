// SPDX-License-Identifier: BSD-3-Clause
// Example sketch of an Arduino library with a controller.

/* Controls what is measured at MEASURED_PIN by OUTPUT_PIN, every SAMPLE_MICROSECONDS microseconds.
   Set the three scales to your plant: the controller works in the units that it was designed in. */
#include <NAME.h>

#define MEASURED_PIN A0
#define OUTPUT_PIN 9
static const REAL setpoint = 1;
static const REAL measured_per_count = REAL(5) / 1023;
static const REAL counts_per_output = 255;

static NAME_state state;
static unsigned long next_time;

void setup()
{
  pinMode(OUTPUT_PIN, OUTPUT);
  NAME_init(&state);
  next_time = micros();
}

void loop()
{
  /* The difference of two times is right even where micros() has begun anew. */
  if ((long)(micros() - next_time) < 0) return;
  next_time += SAMPLE_MICROSECONDS;
  const REAL measured = (REAL)analogRead(MEASURED_PIN) * measured_per_count;
  const REAL counts = NAME_step(&state, setpoint, measured) * counts_per_output;
  analogWrite(OUTPUT_PIN, counts <= 0 ? 0 : counts >= 255 ? 255 : (int)counts);
}
