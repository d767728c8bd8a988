"""Sonar logs to 3D occupancy maps.

    import pingvox
    recording = pingvox.open("dive.bin", nav="dive.tlog")
    map = recording.map(resolution=0.1)
    map.save("dive.bt")

Lengths are metres and times seconds; angles are radians in arrays, and degrees in options, as in the program.
options_of("Recording.map") lists what a function takes.
"""

from enum import IntEnum as _IntEnum

from . import live_event
from ._error import Error
from ._pingvox import (
    Beam,
    BeamMapper,
    Beams,
    Echoes,
    HeadStatus,
    Leaves,
    LiveEvent,
    LiveEvents,
    LiveMapping,
    LiveNavStatus,
    LiveSlamStatus,
    LiveStatus,
    LocateResult,
    NearestCells,
    OccupancyMap,
    RayEnds,
    Recording,
    RecordingMap,
    SlamResult,
    Slice,
    Sweep,
    Trajectory,
    __version__,
    filter_image,
    open,
    options_of,
)


class Occupancy(_IntEnum):
    """What is known of a cell: the values in arrays called occupancy."""

    UNKNOWN = 0
    FREE = 1
    OCCUPIED = 2


UNKNOWN = Occupancy.UNKNOWN
FREE = Occupancy.FREE
OCCUPIED = Occupancy.OCCUPIED

__all__ = [
    "FREE",
    "OCCUPIED",
    "UNKNOWN",
    "Beam",
    "BeamMapper",
    "Beams",
    "Echoes",
    "Error",
    "HeadStatus",
    "Leaves",
    "LiveEvent",
    "LiveEvents",
    "LiveMapping",
    "LiveNavStatus",
    "LiveSlamStatus",
    "LiveStatus",
    "LocateResult",
    "NearestCells",
    "Occupancy",
    "OccupancyMap",
    "RayEnds",
    "Recording",
    "RecordingMap",
    "SlamResult",
    "Slice",
    "Sweep",
    "Trajectory",
    "__version__",
    "filter_image",
    "live_event",
    "open",
    "options_of",
]
