#!/usr/bin/env python3
"""Prints the tests that use the most CPU time, and those that tests/long.txt lists wrongly.

Usage: long.py TESTLOG_JSON CPU_TIMES LONG_TXT, where tests/cpu-time.sh wrote CPU_TIMES.
"""
import json
import sys

LONG_S = 2.0  # a test above it belongs to the list, one below half of it does not

log, times, listed = sys.argv[1:]
with open(times) as file:
    seconds = {}
    for line in file:
        user, system, command = line.rstrip("\n").split(" ", 2)
        seconds[command] = float(user) + float(system)
with open(log) as file:
    runs = [json.loads(line) for line in file]
with open(listed) as file:
    long_tests = {line.strip() for line in file if not line.startswith("#")}

used = {}  # by name; of two tests of one name the longer
for run in runs:
    name = run["name"].split(" / ")[1]
    s = seconds.get(" ".join(run["command"][1:]))  # the first word is the wrapper
    if s is not None:
        used[name] = max(s, used.get(name, 0.0))
print(f"CPU time of {len(seconds)} tests: {sum(seconds.values()):.0f} s; the most of it:")
for name in sorted(used, key=used.get, reverse=True)[:12]:
    print(f"  {used[name]:6.1f} s {name}")
for name, s in sorted(used.items()):
    if s > LONG_S and name not in long_tests and not name.startswith("fuzz_"):
        print(f"tests/long.txt lacks '{name}', which takes {s:.1f} s")
    elif s < LONG_S / 2 and name in long_tests:
        print(f"tests/long.txt has '{name}', which takes only {s:.1f} s")
for name in sorted(long_tests - used.keys()):
    print(f"tests/long.txt has '{name}', which is no fast test")
