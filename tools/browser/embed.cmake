# SPDX-License-Identifier: BSD-3-Clause
# The script of the program, wasm inside, in the place that the page keeps for it.
cmake_minimum_required(VERSION 3.22)
file(READ ${PAGE} page)
file(READ ${PROGRAM} program)
string(FIND "${page}" "@PROGRAM@" place)
string(SUBSTRING "${page}" 0 ${place} before)
math(EXPR place "${place} + 9")
string(SUBSTRING "${page}" ${place} -1 after)
string(REPLACE "</script" "<\\/script" program "${program}")
file(WRITE ${OUTPUT} "${before}${program}${after}")
