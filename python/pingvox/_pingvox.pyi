"""The library pingvox; `help(pingvox.open)` and `pingvox.options_of` say what options mean."""

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, overload

import numpy as np
import numpy.typing as npt

from ._error import Error

__version__: str

_Path = str | os.PathLike[str]
_Number = float | np.floating[Any]
_Whole = int | np.integer[Any]
_Paths = _Path | Sequence[_Path]
# "0.4,0,-0.2,180,0,0" or (0.4, 0, -0.2, 180, 0, 0)
_Numbers = str | Sequence[float] | npt.NDArray[Any]
# "A50=0,0,0,0,0,45", several of them, or {"A50": (0, 0, 0, 0, 0, 45)}
_Many = str | Sequence[str] | Mapping[str, object]
_Floats = npt.NDArray[np.float64]
_Bytes = npt.NDArray[np.uint8]
_Bools = npt.NDArray[np.bool_]
_Ints = npt.NDArray[np.int64]

def open(
    logs: _Paths,
    *,
    nav: _Paths | None = ...,
    nav_offset: _Number | None = ...,
    nav_source: _Many | None = ...,
    nav_mount: _Many | None = ...,
    use_calibration: _Path | None = ...,
    poses: _Path | None = ...,
    mount: _Numbers | None = ...,
    device: str | None = ...,
    beam_width: _Number | None = ...,
    beam_height: _Number | None = ...,
    sound_speed: _Number | None = ...,
    water: _Numbers | None = ...,
    background: _Number | None = ...,
    origin: _Numbers | None = ...,
    strict: bool | None = ...,
    topic: str | None = ...,
    fields: _Path | Mapping[str, object] | None = ...,
) -> Recording: ...
def options_of(function: str) -> dict[str, str]: ...
def filter_image(
    image: npt.ArrayLike,
    wrap: bool = ...,
    *,
    filter: Literal["none", "mean", "median", "gaussian"] | None = ...,
    kernel: _Whole | None = ...,
    sigma: _Number | None = ...,
) -> _Bytes: ...

class Recording:
    @property
    def logs(self) -> list[str]: ...
    @property
    def nav_offset(self) -> float: ...
    def path(self) -> Trajectory: ...
    def beams(self, log: _Whole = ...) -> Beams: ...
    def map(
        self,
        trajectory: Trajectory | None = ...,
        *,
        progress: Callable[[int], object] | None = ...,
        resolution: _Number | None = ...,
        depth: _Whole | None = ...,
        hit: _Number | None = ...,
        miss: _Number | None = ...,
        clamp: _Numbers | None = ...,
        vote: Literal["sweep", "beam"] | None = ...,
        parents: Literal["max", "mean"] | None = ...,
        threads: _Whole | None = ...,
        memory_limit: _Whole | str | None = ...,
        occupied: _Number | None = ...,
        free: _Number | None = ...,
        cut_depth: _Whole | None = ...,
        beam: Literal["ray", "fan", "cone"] | None = ...,
        free_share: _Number | None = ...,
        hit_from: Literal["fixed", "intensity"] | None = ...,
        silent: Literal["nothing", "free"] | None = ...,
        ray: Literal["dda", "bresenham"] | None = ...,
        min_range: _Number | Literal["auto"] | None = ...,
        min_bin: _Whole | None = ...,
        max_range: _Number | None = ...,
        filter: Literal["none", "mean", "median", "gaussian"] | None = ...,
        kernel: _Whole | None = ...,
        sigma: _Number | None = ...,
        detect: Literal["rise", "level", "max", "canny", "cfar"] | None = ...,
        threshold: _Whole | Literal["auto"] | None = ...,
        cfar: Literal["ca", "so", "go", "os"] | None = ...,
    ) -> RecordingMap: ...
    def slam(
        self,
        *,
        matching: Literal["pairs", "none"] | None = ...,
        causal: bool | None = ...,
        seed: _Whole | None = ...,
        min_range: _Number | Literal["auto"] | None = ...,
        min_bin: _Whole | None = ...,
        max_range: _Number | None = ...,
        filter: Literal["none", "mean", "median", "gaussian"] | None = ...,
        kernel: _Whole | None = ...,
        sigma: _Number | None = ...,
        detect: Literal["rise", "level", "max", "canny", "cfar"] | None = ...,
        threshold: _Whole | Literal["auto"] | None = ...,
        cfar: Literal["ca", "so", "go", "os"] | None = ...,
    ) -> SlamResult: ...
    def locate(
        self,
        map: OccupancyMap,
        *,
        progress: Callable[[float], object] | None = ...,
        start: _Numbers | None = ...,
        min_z: _Number | None = ...,
        max_z: _Number | None = ...,
        causal: bool | None = ...,
        seed: _Whole | None = ...,
        min_range: _Number | Literal["auto"] | None = ...,
        min_bin: _Whole | None = ...,
        max_range: _Number | None = ...,
        filter: Literal["none", "mean", "median", "gaussian"] | None = ...,
        kernel: _Whole | None = ...,
        sigma: _Number | None = ...,
        detect: Literal["rise", "level", "max", "canny", "cfar"] | None = ...,
        threshold: _Whole | Literal["auto"] | None = ...,
        cfar: Literal["ca", "so", "go", "os"] | None = ...,
    ) -> LocateResult: ...
    def evaluate(
        self,
        *,
        progress: Callable[[float], object] | None = ...,
        folds: _Whole | None = ...,
        resolution: _Number | None = ...,
        depth: _Whole | None = ...,
        hit: _Number | None = ...,
        miss: _Number | None = ...,
        clamp: _Numbers | None = ...,
        vote: Literal["sweep", "beam"] | None = ...,
        threads: _Whole | None = ...,
        memory_limit: _Whole | str | None = ...,
        occupied: _Number | None = ...,
        free: _Number | None = ...,
        beam: Literal["ray", "fan", "cone"] | None = ...,
        free_share: _Number | None = ...,
        hit_from: Literal["fixed", "intensity"] | None = ...,
        silent: Literal["nothing", "free"] | None = ...,
        ray: Literal["dda", "bresenham"] | None = ...,
        min_range: _Number | Literal["auto"] | None = ...,
        min_bin: _Whole | None = ...,
        max_range: _Number | None = ...,
        filter: Literal["none", "mean", "median", "gaussian"] | None = ...,
        kernel: _Whole | None = ...,
        sigma: _Number | None = ...,
        detect: Literal["rise", "level", "max", "canny", "cfar"] | None = ...,
        threshold: _Whole | Literal["auto"] | None = ...,
        cfar: Literal["ca", "so", "go", "os"] | None = ...,
    ) -> dict[str, Any]: ...

class SlamResult:
    @property
    def trajectory(self) -> Trajectory: ...
    @property
    def covariances(self) -> tuple[_Floats, _Floats]: ...
    @property
    def report(self) -> dict[str, Any]: ...
    @property
    def calibration(self) -> str: ...
    def save_calibration(self, path: _Path) -> None: ...
    def map(
        self,
        *,
        progress: Callable[[int], object] | None = ...,
        resolution: _Number | None = ...,
        depth: _Whole | None = ...,
        hit: _Number | None = ...,
        miss: _Number | None = ...,
        clamp: _Numbers | None = ...,
        vote: Literal["sweep", "beam"] | None = ...,
        parents: Literal["max", "mean"] | None = ...,
        threads: _Whole | None = ...,
        memory_limit: _Whole | str | None = ...,
        occupied: _Number | None = ...,
        free: _Number | None = ...,
        cut_depth: _Whole | None = ...,
        beam: Literal["ray", "fan", "cone"] | None = ...,
        free_share: _Number | None = ...,
        hit_from: Literal["fixed", "intensity"] | None = ...,
        silent: Literal["nothing", "free"] | None = ...,
    ) -> RecordingMap: ...

class LocateResult:
    @property
    def trajectory(self) -> Trajectory: ...
    @property
    def known_trajectory(self) -> Trajectory | None: ...
    @property
    def known(self) -> _Bools: ...
    @property
    def is_sure(self) -> bool: ...
    @property
    def hypotheses(self) -> list[dict[str, float]]: ...

class Trajectory:
    def __init__(self, times: npt.ArrayLike, poses: npt.ArrayLike, longest_step: _Number = ...) -> None: ...
    @staticmethod
    def open(path: _Path) -> Trajectory: ...
    def save(self, path: _Path) -> None: ...
    @property
    def times(self) -> _Floats: ...
    @property
    def positions(self) -> _Floats: ...
    @property
    def matrices(self) -> _Floats: ...
    @property
    def gaps(self) -> int: ...
    def at(self, times: npt.ArrayLike) -> _Floats: ...
    def __copy__(self) -> Trajectory: ...
    def __deepcopy__(self, memo: dict[Any, Any]) -> Trajectory: ...
    def __getstate__(self) -> tuple[Any, ...]: ...
    def __setstate__(self, arg0: tuple[Any, ...]) -> None: ...
    def __len__(self) -> int: ...

class OccupancyMap:
    def __init__(
        self,
        *,
        resolution: _Number | None = ...,
        depth: _Whole | None = ...,
        clamp: _Numbers | None = ...,
        parents: Literal["max", "mean"] | None = ...,
        occupied: _Number | None = ...,
        free: _Number | None = ...,
        memory_limit: _Whole | str | None = ...,
    ) -> None: ...
    @staticmethod
    def open(
        path: _Path, memory_limit: _Whole = ..., *, occupied: _Number | None = ..., free: _Number | None = ...
    ) -> OccupancyMap: ...
    def save(self, path: _Path, made_by: str = ...) -> None: ...
    def copy(self) -> OccupancyMap: ...
    def __copy__(self) -> OccupancyMap: ...
    def __deepcopy__(self, memo: dict[Any, Any]) -> OccupancyMap: ...
    def __getstate__(self) -> tuple[Any, ...]: ...
    def __setstate__(self, arg0: tuple[Any, ...]) -> None: ...
    def insert_points(
        self,
        points: npt.ArrayLike,
        origin: npt.ArrayLike,
        *,
        hit: _Number | None = ...,
        miss: _Number | None = ...,
        ray: Literal["dda", "bresenham"] | None = ...,
        max_range: _Number | None = ...,
    ) -> dict[str, int]: ...
    def update(
        self, points: npt.ArrayLike | None = ..., *, keys: npt.ArrayLike | None = ..., probability: _Number
    ) -> None: ...
    def log_odds(
        self, points: npt.ArrayLike | None = ..., *, keys: npt.ArrayLike | None = ...
    ) -> npt.NDArray[np.float32]: ...
    def probability(
        self, points: npt.ArrayLike | None = ..., *, keys: npt.ArrayLike | None = ...
    ) -> npt.NDArray[np.float32]: ...
    def occupancy(self, points: npt.ArrayLike | None = ..., *, keys: npt.ArrayLike | None = ...) -> _Bytes: ...
    def keys(self, points: npt.ArrayLike) -> tuple[npt.NDArray[np.unsignedinteger[Any]], _Bools]: ...
    def centres(self, keys: npt.ArrayLike) -> _Floats: ...
    def cast_rays(
        self,
        origins: npt.ArrayLike,
        directions: npt.ArrayLike,
        max_range: _Number,
        unknown: Literal["pass", "block"] = ...,
    ) -> RayEnds: ...
    def nearest(
        self, points: npt.ArrayLike, max_range: _Number = ..., sought: Literal["occupied", "not_free"] = ...
    ) -> NearestCells: ...
    def leaves(self, max_depth: _Whole | None = ..., box: npt.ArrayLike | None = ...) -> Leaves: ...
    def slice(self, min_z: _Number | None = ..., max_z: _Number | None = ...) -> Slice: ...
    def merge(self, other: OccupancyMap) -> None: ...
    def clear(self) -> None: ...
    def info(self) -> dict[str, Any]: ...
    @property
    def resolution(self) -> float: ...
    @property
    def depth(self) -> int: ...
    @property
    def bounds(self) -> _Floats | None: ...
    @property
    def memory_bytes(self) -> int: ...
    def __len__(self) -> int: ...

class RecordingMap(OccupancyMap):
    def copy(self) -> RecordingMap: ...
    def __copy__(self) -> RecordingMap: ...
    def __deepcopy__(self, memo: dict[Any, Any]) -> RecordingMap: ...
    def __getstate__(self) -> tuple[Any, ...]: ...
    def __setstate__(self, arg0: tuple[Any, ...]) -> None: ...
    @property
    def report(self) -> dict[str, Any]: ...
    @property
    def trajectory(self) -> Trajectory: ...

class RayEnds:
    @property
    def occupancy(self) -> _Bytes: ...
    @property
    def ranges(self) -> _Floats: ...
    @property
    def points(self) -> _Floats: ...
    def __len__(self) -> int: ...

class NearestCells:
    @property
    def ranges(self) -> _Floats: ...
    @property
    def points(self) -> _Floats: ...
    def __len__(self) -> int: ...

class Leaves:
    @property
    def centres(self) -> _Floats: ...
    @property
    def sizes(self) -> _Floats: ...
    @property
    def log_odds(self) -> npt.NDArray[np.float32]: ...
    @property
    def occupancy(self) -> _Bytes: ...
    @property
    def depths(self) -> _Bytes: ...
    def __len__(self) -> int: ...

class Slice:
    @property
    def occupancy(self) -> _Bytes: ...
    @property
    def extent(self) -> list[float]: ...

class Beam:
    @property
    def time(self) -> float: ...
    @property
    def bearing(self) -> float: ...
    @property
    def bin_length(self) -> float: ...
    @property
    def intensities(self) -> _Bytes: ...

class Beams:
    def __init__(
        self,
        times: npt.ArrayLike,
        bearings: npt.ArrayLike,
        bin_length: _Number,
        intensities: npt.ArrayLike,
        bins: Sequence[int] | npt.NDArray[np.integer[Any]] | None = ...,
    ) -> None: ...
    @property
    def times(self) -> _Floats: ...
    @property
    def bearings(self) -> _Floats: ...
    @property
    def bin_lengths(self) -> _Floats: ...
    @property
    def bins(self) -> _Ints: ...
    @property
    def intensities(self) -> _Bytes: ...
    @property
    def skipped(self) -> int: ...
    @property
    def note(self) -> str: ...
    def sweeps(self) -> list[Sweep]: ...
    def echoes(
        self,
        *,
        min_range: _Number | Literal["auto"] | None = ...,
        min_bin: _Whole | None = ...,
        max_range: _Number | None = ...,
        filter: Literal["none", "mean", "median", "gaussian"] | None = ...,
        kernel: _Whole | None = ...,
        sigma: _Number | None = ...,
        detect: Literal["rise", "level", "max", "canny", "cfar"] | None = ...,
        threshold: _Whole | Literal["auto"] | None = ...,
        cfar: Literal["ca", "so", "go", "os"] | None = ...,
    ) -> Echoes: ...
    @overload
    def __getitem__(self, index: _Whole) -> Beam: ...
    @overload
    def __getitem__(self, index: slice) -> Beams: ...
    def __iter__(self) -> Iterator[Beam]: ...
    def __len__(self) -> int: ...

class Sweep:
    @property
    def extent(self) -> str: ...
    @property
    def image(self) -> _Bytes: ...
    def beams(self) -> Beams: ...
    def filtered(
        self,
        *,
        filter: Literal["none", "mean", "median", "gaussian"] | None = ...,
        kernel: _Whole | None = ...,
        sigma: _Number | None = ...,
    ) -> _Bytes: ...
    def echoes(
        self,
        *,
        min_range: _Number | Literal["auto"] | None = ...,
        min_bin: _Whole | None = ...,
        max_range: _Number | None = ...,
        filter: Literal["none", "mean", "median", "gaussian"] | None = ...,
        kernel: _Whole | None = ...,
        sigma: _Number | None = ...,
        detect: Literal["rise", "level", "max", "canny", "cfar"] | None = ...,
        threshold: _Whole | Literal["auto"] | None = ...,
        cfar: Literal["ca", "so", "go", "os"] | None = ...,
    ) -> Echoes: ...
    def __len__(self) -> int: ...

class Echoes:
    @property
    def found(self) -> _Bools: ...
    @property
    def ranges(self) -> _Floats: ...
    @property
    def intensities(self) -> _Bytes: ...
    @property
    def first(self) -> _Ints: ...
    @property
    def peak(self) -> _Ints: ...
    @property
    def last(self) -> _Ints: ...
    @property
    def thresholds(self) -> npt.NDArray[np.int32]: ...
    def __len__(self) -> int: ...

class BeamMapper:
    def __init__(
        self,
        map: OccupancyMap,
        *,
        hit: _Number | None = ...,
        miss: _Number | None = ...,
        vote: Literal["sweep", "beam"] | None = ...,
        threads: _Whole | None = ...,
        mount: _Numbers | None = ...,
        beam: Literal["ray", "fan", "cone"] | None = ...,
        beam_width: _Number | None = ...,
        beam_height: _Number | None = ...,
        device: str | None = ...,
        free_share: _Number | None = ...,
        ray: Literal["dda", "bresenham"] | None = ...,
        hit_from: Literal["fixed", "intensity"] | None = ...,
        silent: Literal["nothing", "free"] | None = ...,
        sound_speed: _Number | None = ...,
        water: _Numbers | None = ...,
        min_range: _Number | Literal["auto"] | None = ...,
        min_bin: _Whole | None = ...,
        max_range: _Number | None = ...,
        filter: Literal["none", "mean", "median", "gaussian"] | None = ...,
        kernel: _Whole | None = ...,
        sigma: _Number | None = ...,
        detect: Literal["rise", "level", "max", "canny", "cfar"] | None = ...,
        threshold: _Whole | Literal["auto"] | None = ...,
        cfar: Literal["ca", "so", "go", "os"] | None = ...,
    ) -> None: ...
    def add_beams(self, beams: Beams, trajectory: Trajectory | None = ...) -> None: ...
    def add(
        self,
        time: _Number,
        bearing: _Number,
        bin_length: _Number,
        intensities: npt.ArrayLike,
        pose: npt.ArrayLike | None,
    ) -> None: ...
    def finish(self) -> None: ...
    @property
    def map(self) -> OccupancyMap: ...
    @property
    def report(self) -> dict[str, Any]: ...

class LiveMapping:
    def __init__(
        self,
        head: str,
        *,
        record: _Path | None = ...,
        range: _Number | None = ...,
        sector: _Numbers | None = ...,
        step: _Number | None = ...,
        gain: Literal["low", "normal", "high"] | None = ...,
        timeout: _Number | None = ...,
        nav: str | Sequence[str] | None = ...,
        obstacles: str | None = ...,
        publish: str | None = ...,
        publish_every: _Number | None = ...,
        ros_domain: _Whole | None = ...,
        ros_interface: str | None = ...,
        ros_distribution: Literal["humble", "iron", "jazzy", "kilted", "rolling"] | None = ...,
        slam: bool | None = ...,
        nav_mount: _Many | None = ...,
        map: _Path | None = ...,
        start: _Numbers | None = ...,
        resolution: _Number | None = ...,
        depth: _Whole | None = ...,
        hit: _Number | None = ...,
        miss: _Number | None = ...,
        clamp: _Numbers | None = ...,
        vote: Literal["sweep", "beam"] | None = ...,
        memory_limit: _Whole | str | None = ...,
        mount: _Numbers | None = ...,
        beam: Literal["ray", "fan", "cone"] | None = ...,
        beam_width: _Number | None = ...,
        beam_height: _Number | None = ...,
        device: str | None = ...,
        free_share: _Number | None = ...,
        ray: Literal["dda", "bresenham"] | None = ...,
        hit_from: Literal["fixed", "intensity"] | None = ...,
        silent: Literal["nothing", "free"] | None = ...,
        min_range: _Number | Literal["auto"] | None = ...,
        min_bin: _Whole | None = ...,
        max_range: _Number | None = ...,
        sound_speed: _Number | None = ...,
        water: _Numbers | None = ...,
        filter: Literal["none", "mean", "median", "gaussian"] | None = ...,
        kernel: _Whole | None = ...,
        sigma: _Number | None = ...,
        detect: Literal["rise", "level", "max", "canny", "cfar"] | None = ...,
        threshold: _Whole | Literal["auto"] | None = ...,
        cfar: Literal["ca", "so", "go", "os"] | None = ...,
    ) -> None: ...
    def __enter__(self) -> LiveMapping: ...
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None: ...
    def events(self) -> LiveEvents: ...
    def take_events(self) -> list[LiveEvent]: ...
    def wait(self, seconds: float) -> bool: ...
    def finish(self) -> None: ...
    @property
    def map(self) -> OccupancyMap: ...
    @property
    def report(self) -> dict[str, Any]: ...
    @property
    def coverage(self) -> dict[str, Any]: ...
    @property
    def status(self) -> LiveStatus: ...
    @property
    def time(self) -> float: ...
    @property
    def since_1970(self) -> float: ...
    @property
    def path(self) -> Trajectory | None: ...
    @property
    def pose(self) -> tuple[float, _Floats] | None: ...
    @property
    def recordings(self) -> list[Path]: ...
    @property
    def is_recording(self) -> bool: ...
    def begin_recording(self) -> None: ...
    def end_recording(self) -> None: ...
    def begin_new_map(self) -> OccupancyMap: ...
    def drive(
        self,
        *,
        range: _Number | None = ...,
        sector: _Numbers | None = ...,
        step: _Number | None = ...,
        gain: Literal["low", "normal", "high"] | None = ...,
        timeout: _Number | None = ...,
    ) -> None: ...
    def take_beams(self) -> Beams: ...
    def take_latency(self) -> float: ...

class LiveEvents:
    def __iter__(self) -> Iterator[LiveEvent]: ...
    def __next__(self) -> LiveEvent: ...

class LiveEvent:
    @property
    def error(self) -> Error | None: ...
    def __str__(self) -> str: ...

class Connected(LiveEvent):
    @property
    def device(self) -> str: ...

class NotConnected(LiveEvent):
    @property
    def device(self) -> str: ...
    @property
    def reason(self) -> str: ...

class RecordingFailed(LiveEvent):
    @property
    def error(self) -> Error: ...

class MappingFailed(LiveEvent):
    @property
    def error(self) -> Error: ...

class NavFailed(LiveEvent):
    @property
    def error(self) -> Error: ...

class UnexpectedBeam(LiveEvent):
    @property
    def device(self) -> str: ...
    @property
    def reason(self) -> str: ...

class SourcesChosen(LiveEvent):
    @property
    def attitude(self) -> str: ...
    @property
    def position(self) -> str: ...

class NoSourceYet(LiveEvent):
    @property
    def has_attitude(self) -> bool: ...
    @property
    def has_position(self) -> bool: ...
    @property
    def messages(self) -> int: ...

class PosesEnded(LiveEvent): ...

class PosesResumed(LiveEvent): ...

class BeamsWithoutPose(LiveEvent):
    @property
    def beams(self) -> int: ...
    @property
    def without_pose(self) -> int: ...
    @property
    def within(self) -> float: ...
    @property
    def behind(self) -> float | None: ...
    @property
    def apart(self) -> float | None: ...

class BeamsWithPose(LiveEvent): ...

class ClocksDiffer(LiveEvent):
    @property
    def device(self) -> str: ...
    @property
    def head(self) -> str: ...
    @property
    def ahead(self) -> float: ...

class VehicleChanged(LiveEvent):
    @property
    def device(self) -> str: ...
    @property
    def vehicle(self) -> str: ...

class SenderIgnored(LiveEvent):
    @property
    def device(self) -> str: ...
    @property
    def sender(self) -> str: ...
    @property
    def vehicle(self) -> str: ...

class SenderRestarted(LiveEvent):
    @property
    def device(self) -> str: ...
    @property
    def position(self) -> str: ...

class NewFrame(LiveEvent):
    @property
    def source(self) -> str: ...
    @property
    def quantity(self) -> str: ...
    @property
    def step(self) -> dict[str, Any]: ...

class ObstaclesNotSent(LiveEvent):
    @property
    def reason(self) -> str: ...

class ObstaclesSent(LiveEvent): ...

class NotPublished(LiveEvent):
    @property
    def reason(self) -> str: ...

class MotionChosen(LiveEvent):
    @property
    def motion(self) -> str: ...
    @property
    def velocity(self) -> str: ...
    @property
    def heading(self) -> str: ...
    @property
    def deviation(self) -> float | None: ...

class Located(LiveEvent):
    @property
    def map(self) -> str: ...
    @property
    def where(self) -> dict[str, float]: ...

class NotLocated(LiveEvent):
    @property
    def map(self) -> str: ...
    @property
    def sweeps(self) -> int: ...
    @property
    def hypotheses(self) -> list[dict[str, float]]: ...

class VelocityEnded(LiveEvent):
    @property
    def velocity(self) -> str: ...

class VelocityResumed(LiveEvent):
    @property
    def velocity(self) -> str: ...
    @property
    def missing(self) -> float: ...

class PositionUncertain(LiveEvent):
    @property
    def deviation(self) -> float: ...

class LoopClosed(LiveEvent):
    @property
    def loops(self) -> int: ...
    @property
    def moved(self) -> float: ...

class SlamFailed(LiveEvent):
    @property
    def error(self) -> Error: ...

class MessagesRefused(LiveEvent):
    @property
    def device(self) -> str: ...
    @property
    def reason(self) -> str: ...

class SeveralPublishers(LiveEvent):
    @property
    def device(self) -> str: ...
    @property
    def publishers(self) -> int: ...

class HeadStatus:
    @property
    def is_connected(self) -> bool: ...
    @property
    def connections(self) -> int: ...
    @property
    def problem(self) -> str: ...
    @property
    def unanswered(self) -> int: ...
    @property
    def damaged(self) -> int: ...
    @property
    def unexpected(self) -> int: ...
    @property
    def first_unexpected(self) -> str: ...
    @property
    def recording_error(self) -> Error | None: ...

class LiveNavStatus:
    @property
    def kind(self) -> Literal["mavlink", "a50", "ros2"]: ...
    @property
    def name(self) -> str: ...
    @property
    def is_connected(self) -> bool: ...
    @property
    def connections(self) -> int: ...
    @property
    def problem(self) -> str: ...
    @property
    def messages(self) -> int: ...
    @property
    def damaged(self) -> int: ...
    @property
    def recording_error(self) -> Error | None: ...
    @property
    def vehicle(self) -> str: ...
    @property
    def vehicles(self) -> int: ...
    @property
    def ignored(self) -> int: ...
    @property
    def others(self) -> list[str]: ...

class LiveSlamStatus:
    @property
    def motion(self) -> str: ...
    @property
    def velocity(self) -> str | None: ...
    @property
    def heading(self) -> str | None: ...
    @property
    def deviation_of_motion(self) -> float | None: ...
    @property
    def loops(self) -> int: ...
    @property
    def corrections(self) -> int: ...
    @property
    def is_correcting(self) -> bool: ...
    @property
    def located(self) -> dict[str, float] | None: ...
    @property
    def without_velocity(self) -> float: ...
    @property
    def deviation(self) -> float: ...
    @property
    def predicted(self) -> tuple[float, _Floats] | None: ...

class LiveStatus:
    @property
    def time(self) -> float: ...
    @property
    def head(self) -> HeadStatus: ...
    @property
    def beams(self) -> int: ...
    @property
    def mapped(self) -> int: ...
    @property
    def not_mapped(self) -> int: ...
    @property
    def waiting(self) -> int: ...
    @property
    def without_pose(self) -> int: ...
    @property
    def nav(self) -> list[LiveNavStatus]: ...
    @property
    def attitude(self) -> str: ...
    @property
    def position(self) -> str: ...
    @property
    def outliers(self) -> int: ...
    @property
    def new_frames(self) -> int: ...
    @property
    def slam(self) -> LiveSlamStatus | None: ...
