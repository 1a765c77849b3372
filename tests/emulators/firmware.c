/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs an exported controller on a processor or its emulator and prints the bits of its outputs, one sample a line, for
 * reference.cpp to be compared with; on an AVR also the cycles of the longest and of the mean step.
 *
 * Defined by the command line: HEADER, the file; IS_FILTER where it has one input, IS_FIXED where samples are whole
 * numbers; REAL and BITS, the type of a sample and an unsigned one of its size; SAMPLES.
 */
#include <stdint.h>

#include HEADER

#ifndef __ARM_ARCH_6M__
#include <string.h>
#endif

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
#elif defined(__ARM_ARCH_6M__)
#include "cortex_m0.h"
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

static model_state state;

/* Set-points that jump and drive the output to its limits. */
static REAL jumping(int n)
{
#ifdef IS_FIXED
  return (REAL)(n / 50 % 3) * 536870912;
#else
  return (REAL)(n / 50 % 3);
#endif
}

#if defined(__GNUC__) && !defined(__AVR__)
__attribute__((noinline))
#endif
static REAL
step(REAL setpoint, REAL measured)
{
#if defined(IS_FIXED) && defined(IS_FILTER)
  (void)setpoint;
  return model_step(&state, measured);
#elif defined(IS_FILTER)
  return model_step(&state, setpoint - measured);
#else
  return model_step(&state, setpoint, measured);
#endif
}

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
    const REAL setpoint = jumping(n);
    const REAL measured = draw();
    volatile REAL output;
    BITS bits;
#ifdef __AVR__
    const uint16_t before = TCNT1;
    uint16_t cycles;
    output = step(setpoint, measured);
    cycles = (uint16_t)(TCNT1 - before);
    if (cycles > longest) longest = cycles;
    sum += cycles;
#else
    output = step(setpoint, measured);
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
