#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What it costs that a map streams, is resumed, shared out and joined, and how it scales to two cores.

tests/benchmarks/stream_costs.py [--points N] [--shard-points N] [--picture weak-scaling.svg] [program]

Times are processor seconds of the processes, so that other work on the machine changes them little; the least of
several runs where a run is short.  Weak scaling is that of processes that run at the same time, each on its part.
"""

import argparse
import filecmp
import os
import pathlib
import signal
import subprocess
import tempfile
import time

CLOCK = os.sysconf("SC_CLK_TCK")


class Bench:
    def __init__(self, program, side, folder):
        self.program, self.side, self.folder = program, side, pathlib.Path(folder)

    def request(self, side=None):
        side = side or self.side
        return ["map", "--restitution", f"0.05:1:{side}", "--omega", f"0.5:4:{side}log", "--threads", "1", "--quiet"]

    def run(self, *words):
        """Processor seconds, seconds, and the most memory in MB."""
        begin = time.perf_counter()
        with subprocess.Popen([self.program, *map(str, words)], stdout=subprocess.DEVNULL) as process:
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        assert process.returncode in (0, 1), words
        return usage.ru_utime + usage.ru_stime, time.perf_counter() - begin, usage.ru_maxrss / 1024

    def path(self, name):
        return self.folder / name

    def streaming(self):
        """Share of a map's time that goes into rows on disk as they come."""
        pairs = []
        for _ in range(5):
            whole = self.run(*self.request(), "--out", "-")[0]
            pairs.append((self.run(*self.request(), "--out", self.path("whole.csv"))[0], whole))
        streamed, whole = min(pair[0] for pair in pairs), min(pair[1] for pair in pairs)
        print(f"a map of {self.side}^2 points,{whole:.2f} s,")
        print(f"streaming adds,{100 * (streamed / whole - 1):.1f} %,<= 2 %")
        return whole / self.side**2

    def shards(self, side, count=8):
        times = []
        for i in range(1, count + 1):
            words = [*self.request(side), "--shard", f"{i}/{count}", "--out", self.path(f"{i}.csv")]
            times.append(self.run(*words)[0])
        print(f"longest of {count} shards of {side}^2 points,{max(times) * count / sum(times):.3f} of the mean,<= 1.05")
        joined = self.path("joined.csv")
        parts = [self.path(f"{i}.csv") for i in range(1, count + 1)]
        runs = [self.run("merge", *parts, "--out", joined) for _ in range(3)]
        size = joined.stat().st_size / 1e6
        print(f"merge of {size:.0f} MB,{size / min(r[0] for r in runs):.0f} MB/s,>= 200 MB/s")
        print(f"its memory,{max(r[2] for r in runs):.0f} MB,<= 50 MB")
        print(f"bytes of a row,{1e6 * size / side**2:.0f},")

    def overhead(self):
        """A shard without rows, as there are more shards than restitutions."""
        words = ["map", "--restitution", "0.5,0.6", "--omega", "1:2:1000log", "--quiet", "--shard", "3/3", "--out"]
        least = min(self.run(*words, self.path("empty.csv"))[0] for _ in range(10))
        print(f"a shard without rows,{1000 * least:.0f} ms,<= 100 ms")

    def restart(self):
        """The most processor time between two rows on disk, which is what a kill can lose."""
        path = self.path("killed.csv")
        partial = self.path("killed.csv.partial")
        words = [self.program, *self.request(), "--out", path]
        with subprocess.Popen(words) as process:
            last, size, most = 0.0, 0, 0.0
            while process.poll() is None:
                try:
                    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
                    now = (int(fields[11]) + int(fields[12])) / CLOCK
                    grown = partial.stat().st_size
                except (FileNotFoundError, ProcessLookupError):
                    continue
                if grown != size:
                    most, last, size = max(most, now - last), now, grown
                time.sleep(0.005)
        print(f"most that a kill loses,{most:.2f} s,<= 1 s")
        begun = subprocess.Popen(words)
        time.sleep(0.3)
        begun.send_signal(signal.SIGKILL)
        begun.wait()
        self.run(*self.request(), "--out", path)
        # Read in parts: the memory of this process would count for those that it starts.
        assert filecmp.cmp(path, self.path("whole.csv"), shallow=False)

    def weak_scaling(self):
        """Processor time per point of one process alone, and of two at once with twice the points."""
        def at_once(count):
            begun = [subprocess.Popen([self.program, *self.request(), "--shard", f"{i + 1}/{count}", "--out",
                                       str(self.path(f"{count}-{i}.csv"))]) for i in range(count)]
            seconds = 0.0
            for process in begun:
                _, status, usage = os.wait4(process.pid, 0)
                process.returncode = status
                seconds += usage.ru_utime + usage.ru_stime
            return seconds
        alone = min(at_once(1) for _ in range(3))
        both = min(at_once(2) for _ in range(3))
        print(f"efficiency on two cores,{alone / both:.2f},")
        return [(1, 1.0), (2, alone / both)]


def draw(scaling, path):
    points = "\\n".join(f"{cores} {efficiency}" for cores, efficiency in scaling)
    script = (f"set terminal svg size 520,320\nset output '{path}'\nset xlabel 'cores'\nset ylabel 'efficiency'\n"
              "set xrange [0.5:2.5]\nset yrange [0:1.1]\nset xtics 1\nset grid y\nset key bottom left\n"
              f"$data << END\n{points.replace(chr(92) + 'n', chr(10))}\nEND\n"
              "plot 1 title 'ideal' lt 0, $data title 'points per core and second, over those of one core' "
              "with linespoints pt 7 lw 2\n")
    subprocess.run(["gnuplot"], input=script, text=True, check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points", type=int, default=62_500, help="of the maps that run several times")
    parser.add_argument("--shard-points", type=int, default=1_000_000, help="of the map that is shared out")
    parser.add_argument("--picture")
    parser.add_argument("program", nargs="?", default="build/tools/fracfit/fracfit")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(str(pathlib.Path(given.program).resolve()), round(given.points**0.5), folder)
        print("what,measured,goal", flush=True)
        seconds = bench.streaming()
        print(f"a point,{1e6 * seconds:.0f} us,")
        print(f"10^9 points,{1e9 * seconds / 3600:.1f} core hours,")
        bench.overhead()
        bench.restart()
        scaling = bench.weak_scaling()
        bench.shards(round(given.shard_points**0.5))
    if given.picture:
        draw(scaling, given.picture)


main()
