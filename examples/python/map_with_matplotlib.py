"""Maps a log, and shows the map from above beside one sweep with its echoes.

    map_with_matplotlib.py LOG [PICTURE.png]
"""

import sys

import matplotlib
import numpy as np
import pingvox

if len(sys.argv) > 2:
    matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.colors import ListedColormap

recording = pingvox.open(sys.argv[1])
made = recording.map(resolution=0.1)
print(f"{made.report['beams']} beams, {made.report['echoes']} echoes, {len(made)} leaves")

figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5))
above = made.slice()
colours = ListedColormap(["lightgrey", "white", "black"])  # UNKNOWN, FREE, OCCUPIED
left.imshow(above.occupancy, origin="lower", extent=above.extent, cmap=colours, vmin=0, vmax=2)
left.set(title="The map from above", xlabel="x [m]", ylabel="y [m]")

sweep = recording.beams().sweeps()[0]
echoes = sweep.echoes()
right.imshow(sweep.image, aspect="auto", cmap="viridis")
right.plot(echoes.peak[echoes.found], np.flatnonzero(echoes.found), ".", color="orange", markersize=3)
right.set(title="The first sweep and its echoes", xlabel="bin", ylabel="beam")
if len(sys.argv) > 2:
    figure.savefig(sys.argv[2], dpi=100)
else:
    plt.show()
