"""Times `rgbdt replay` on a log, again and again: replay_times.py RGBDT LOG SECONDS RUNS CSV."""

import csv
import os
import re
import subprocess
import sys
import tempfile
import time


def replay(rgbdt, log):
    """Wall clock [s], processor time [s] and most memory [MB] of one replay."""
    with tempfile.TemporaryDirectory() as out:
        began = time.monotonic()
        command = [rgbdt, "replay", log, "--out", out]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        said = process.stdout.read().decode()
        _, status, used = os.wait4(process.pid, 0)
        wall = time.monotonic() - began
    if status != 0 or not re.search(r"coloured [1-9]", said):
        sys.exit(f"replay_times: {said}")
    return wall, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def main():
    rgbdt, log, seconds, runs, path = sys.argv[1:]
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("log_s", "wall_s", "processor_s", "peak_mb"))
        for _ in range(int(runs)):
            writer.writerow((seconds, *replay(rgbdt, log)))


main()
