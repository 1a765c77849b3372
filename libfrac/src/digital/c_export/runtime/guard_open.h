// SPDX-License-Identifier: BSD-3-Clause
// Head of every exported header.  The comment of the export goes in place of COMMENT, the include guard in place of
// GUARD.

/*
COMMENT
 * C99, no heap, no mathematical library.  All state is in one struct.
 */
#if defined(GUARD) && !defined(GUARD_CONTENT)
#error "another controller with the name 'NAME' is already included; export one under another name"
#endif
#ifndef GUARD
#define GUARD
#define GUARD_CONTENT

#if IS_DOUBLE
#include <float.h>
#if DBL_MANT_DIG != 53
#error "the double of this compiler has no 53 bits; export in single precision"
#endif

#endif
/* Products are not to be fused into sums: the last bits would differ. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__) && !defined(__STRICT_ANSI__) && (defined(__FP_FAST_FMA) || defined(__FP_FAST_FMAF))
#pragma GCC push_options
#pragma GCC optimize("fp-contract=off")
#define GUARD_POP_OPTIONS
#endif

