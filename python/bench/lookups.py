"""Times a million look-ups in one call against the same in C++ (the target python_lookups), in turns.

    cmake --build BUILD --target _pingvox python_lookups
    PYTHONPATH=BUILD/python /usr/bin/python3 python/bench/lookups.py BUILD/bin/python_lookups MAP
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pingvox

POINTS = 1_000_000
program, map_file = sys.argv[1:3]
made = pingvox.OccupancyMap.open(map_file)
bounds = made.bounds
assert bounds is not None, "the map is empty"
places = np.random.default_rng(1).uniform(bounds[0], bounds[1], (POINTS, 3))
keys = made.keys(places)[0]


def best(call: str) -> float:
    times = []
    for _ in range(5):
        start = time.perf_counter()
        made.log_odds(places) if call == "points" else made.log_odds(keys=keys)
        times.append(time.perf_counter() - start)
    return min(times)


with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "points"
    file.write_bytes(places.tobytes())
    rounds = []
    for _ in range(5):
        told = subprocess.run([program, map_file, str(file)], capture_output=True, text=True, check=True).stdout.split()
        rounds.append((float(told[0]), best("points"), best("keys")))
    assert abs(float(told[1]) - float(np.nansum(made.log_odds(places).astype(np.float64)))) < 1.0
cpp, by_points, by_keys = (min(times) for times in zip(*rounds))
ratio = np.median([python / own for own, python, by_key in rounds])
print(f"{POINTS} look-ups: C++ {1e3 * cpp:.1f} ms, Python {1e3 * by_points:.1f} ms, by keys {1e3 * by_keys:.1f} ms")
print(f"Python / C++: {ratio:.2f} (median of {len(rounds)} rounds)")
