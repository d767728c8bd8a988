"""Estimates where a vehicle was, and maps its dive along that path: the cells of a notebook, one after another.

    slam.py LOG NAV [MAP.bt]
"""

# %% Open the dive
import sys

import numpy as np
import pingvox

log, nav = sys.argv[1:3]
dive = pingvox.open(log, nav=nav)
print(f"nav clock: {dive.nav_offset:+.3f} s")

# %% Estimate the path from sonar and navigation
found = dive.slam()
path = found.trajectory
way = np.linalg.norm(np.diff(path.positions, axis=0), axis=1).sum()
print(f"{len(path)} poses, {way:.0f} m in {path.times[-1] - path.times[0]:.0f} s")
print(f"{found.report['pairs']} pairs of echoes, loops: {found.report['loops']}")

# %% How well is it known?
times, covariances = found.covariances
deviations = np.sqrt(covariances[:, 0, 0] + covariances[:, 1, 1])
print(f"standard deviation of the place: {deviations.max():.2f} m at most, at {times[deviations.argmax()]:.0f} s")

# %% Map along it, and ask what the vehicle had around it
made = found.map(resolution=0.2)
near = made.nearest(path.positions, max_range=20.0)
print(f"nearest wall: {near.ranges.min():.2f} m at {path.times[near.ranges.argmin()]:.0f} s")
if len(sys.argv) > 3:
    made.save(sys.argv[3])
