// SPDX-License-Identifier: BSD-3-Clause
// End of every exported header; see guard_open.h.


#ifdef GUARD_POP_OPTIONS
#pragma GCC pop_options
#undef GUARD_POP_OPTIONS
#endif

#endif
