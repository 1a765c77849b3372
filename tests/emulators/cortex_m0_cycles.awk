# SPDX-License-Identifier: BSD-3-Clause
# Cycles of each call of `step` on a Cortex-M0 without wait states and with the multiplier of one cycle, by the table of
# instruction timings of its reference manual, from a trace of every instruction.
#
# usage: awk -f cortex_m0_cycles.awk <output of objdump -d> <trace of qemu -singlestep -d exec,nochain>
# Prints the longest, the mean, and the number of calls.

function cycles_of(name, operands,   registers, parts, count, i, ends) {
  if (name ~ /^(push|pop|ldm|stm)/) {
    registers = operands
    sub(/^[^{]*\{/, "", registers)
    sub(/\}.*/, "", registers)
    count = split(registers, parts, /, */)
    for (i = 1; i <= count; ++i)
      if (parts[i] ~ /-/) {
        split(parts[i], ends, "-")
        gsub(/r/, "", ends[1])
        gsub(/r/, "", ends[2])
        count += ends[2] - ends[1]
      }
    return name ~ /^pop/ && registers ~ /pc/ ? count + 4 : count + 1
  }
  if (name ~ /^(ldr|str)/) return 2
  if (name ~ /^bl$/) return 4
  if (name ~ /^(bx|blx)/) return 3
  if (name ~ /^b(\.n|\.w)?$/) return 3
  return 1
}

FNR == NR {
  if ($2 ~ /^<.*>:$/) {
    symbol = substr($2, 2, length($2) - 3)
    if (symbol ~ /^step(\.|$)/) entry = $1
    next
  }
  if ($0 !~ /^ *[0-9a-f]+:\t/) next
  split($0, field, "\t")
  address = field[1]
  gsub(/[ :]/, "", address)
  while (length(address) < 8) address = "0" address
  cost[address] = cycles_of(field[3], field[4])
  conditional[address] = field[3] ~ /^b(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)/
  follows[last] = address
  last = address
  in_main[address] = symbol == "main"
  next
}

/^Trace/ {
  split($0, part, "/")
  address = part[2]
  if (inside && before != "") {
    sum += cost[before]
    if (conditional[before] && address != follows[before]) sum += 2
  }
  if (inside && in_main[address]) {
    inside = 0
    total += sum
    ++calls
    if (sum > longest) longest = sum
  }
  if (address == entry && !inside) {
    inside = 1
    sum = 0
  }
  before = address
}

END { printf("%d %d %d\n", longest, (calls > 0 ? total / calls : 0), calls) }
