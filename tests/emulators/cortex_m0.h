/* SPDX-License-Identifier: BSD-3-Clause */
/* A bare Cortex-M0, as on a micro:bit: the start of the program, and characters by semihosting, which the emulator
 * takes.  For firmware.c. */
#include <stddef.h>
#include <stdint.h>

/* There is no library. */
void *memcpy(void *to, const void *from, size_t count);
void *memcpy(void *to, const void *from, size_t count)
{
  size_t i;
  for (i = 0; i < count; ++i) ((volatile char *)to)[i] = ((const char *)from)[i];
  return to;
}

static uint32_t semihosting(uint32_t operation, const void *argument)
{
  register uint32_t r0 __asm__("r0") = operation;
  register const void *r1 __asm__("r1") = argument;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

static void put(char c)
{
  semihosting(3, &c);
}

int main(void);

static void start(void)
{
  (void)main();
  semihosting(0x18, (const void *)0x20026);
  for (;;) {
  }
}

/* The top of the 16 KB of memory, and the start. */
__attribute__((section(".vectors"), used)) static const struct {
  uint32_t stack;
  void (*reset)(void);
} vectors = {0x20004000, start};
