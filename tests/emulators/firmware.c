/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs an exported controller on a processor or its emulator and prints the bits of its outputs, one sample a line, for
 * reference.cpp to be compared with; on an AVR also the cycles of the longest and of the mean step.
 *
 * Defined by the command line: HEADER, the file; IS_FILTER where it has one input, IS_FIXED where that is a whole
 * number; REAL and BITS, the type of a sample and an unsigned one of its size; SAMPLES.
 */
#include <stdint.h>

#include HEADER

#include <string.h>

#ifdef __AVR__
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>

static void put(char c)
{
  while (!(UCSR0A & (1 << UDRE0))) {
  }
  UDR0 = (uint8_t)c;
}
#else
#include <stdio.h>

static void put(char c)
{
  putchar(c);
}
#endif

static void put_hex(uint64_t value, int digits)
{
  int i;
  for (i = 4 * (digits - 1); i >= 0; i -= 4) put("0123456789abcdef"[(int)(value >> i & 15)]);
  put('\n');
}

static uint32_t drawn = 1;

/* In [-1, 1), 24 bits, which every type here holds; of whole numbers the whole range. */
static REAL draw(void)
{
  drawn = drawn * 1664525u + 1013904223u;
#ifdef IS_FIXED
  return (REAL)drawn;
#else
  return (REAL)((int32_t)drawn / 256) / (REAL)8388608;
#endif
}

#if defined(IS_FIXED)
#define STEP(setpoint, measured) ((void)(setpoint), model_step(&state, measured))
#elif defined(IS_FILTER)
#define STEP(setpoint, measured) model_step(&state, (setpoint) - (measured))
#else
#define STEP(setpoint, measured) model_step(&state, setpoint, measured)
#endif
static model_state state;

int main(void)
{
  int n;
#ifdef __AVR__
  uint16_t longest = 0;
  uint32_t sum = 0;
  UCSR0B = 1 << TXEN0;
  TCCR1A = 0;
  TCCR1B = 1; /* counts every cycle of the processor */
#endif
  model_init(&state);
  for (n = 0; n < SAMPLES; ++n) {
    /* Set-points that jump and drive the output to its limits, and noise. */
    const REAL setpoint = (REAL)(n / 50 % 3);
    const REAL measured = draw();
    volatile REAL output;
    BITS bits;
#ifdef __AVR__
    const uint16_t before = TCNT1;
    uint16_t cycles;
    output = STEP(setpoint, measured);
    cycles = (uint16_t)(TCNT1 - before);
    if (cycles > longest) longest = cycles;
    sum += cycles;
#else
    output = STEP(setpoint, measured);
#endif
    {
      const REAL plain = output;
      memcpy(&bits, &plain, sizeof bits);
    }
    put_hex(bits, 2 * (int)sizeof bits);
  }
#ifdef __AVR__
  put_hex(longest, 8);
  put_hex(sum / SAMPLES, 8);
  cli();
  sleep_enable();
  sleep_cpu(); /* ends the emulator */
#endif
  return 0;
}
