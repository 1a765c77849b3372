# SPDX-License-Identifier: BSD-3-Clause
# Compares two outputs word by word: numbers may differ by one unit of the last digit, all else not at all.
# usage: awk -f same_numbers.awk EXPECTED FOUND
function unit(word,    mantissa, point, exponent) {
  mantissa = word
  exponent = 0
  if (match(word, /[eE][-+]?[0-9]+$/)) {
    mantissa = substr(word, 1, RSTART - 1)
    exponent = substr(word, RSTART + 1) + 0
  }
  point = index(mantissa, ".")
  return (point ? 10 ^ (point - length(mantissa)) : 1) * 10 ^ exponent
}
function fields(line, into) { return split(line, into, /[ ,;:=()]+/) }
FNR == NR { expected[FNR] = $0; lines = FNR; next }
{
  count = fields(expected[FNR], a)
  same = count == fields($0, b)
  number = "^[-+]?[0-9]+([.][0-9]*)?([eE][-+]?[0-9]+)?[j%]?$"
  for (i = 1; i <= count && same; i++) {
    if (a[i] == b[i]) continue
    if (a[i] !~ number || b[i] !~ number) { same = 0; break }
    gsub(/[j%]/, "", a[i]); gsub(/[j%]/, "", b[i])
    difference = a[i] - b[i]
    if (difference < 0) difference = -difference
    if (difference > 1.01 * unit(a[i])) same = 0
  }
  if (!same) { print "expected: " expected[FNR] "\nfound:    " $0 > "/dev/stderr"; wrong = 1 }
  seen = FNR
}
END { exit wrong || seen != lines }
