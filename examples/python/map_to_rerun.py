"""Shows a map and the path of the vehicle in rerun (https://rerun.io), where its Python package is installed.

    map_to_rerun.py LOG [NAV]
"""

import sys

import pingvox

try:
    import rerun as rr
except ImportError:
    sys.exit("rerun is not installed: pip install rerun-sdk")

recording = pingvox.open(sys.argv[1], nav=sys.argv[2:])
made = recording.map()
leaves = made.leaves()
occupied = leaves.occupancy == pingvox.OCCUPIED
sizes = leaves.sizes[occupied, None].repeat(3, axis=1)

rr.init("pingvox", spawn=True)
rr.log("map", rr.Boxes3D(centers=leaves.centres[occupied], sizes=sizes, fill_mode="solid"), static=True)
rr.log("path", rr.LineStrips3D([made.trajectory.positions]), static=True)
