"""LiveMapping with emulated devices, over sockets on the loopback address."""

import math
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pingvox
import pytest
from conftest import PROGRAM, Program
from pingvox import live_event

# A small and quick picture: 20 beams a turn.
QUICK: dict[str, Any] = {"range": 4, "step": 18, "timeout": 0.2, "resolution": 0.1}


@pytest.fixture
def emulate(tmp_path: Path) -> Iterator[Callable[..., str]]:
    """Starts a device and returns the line that it prints: its address."""
    devices = []

    def start(*args: object) -> str:
        device = subprocess.Popen([PROGRAM, "emulate", *map(str, args)], stdout=subprocess.PIPE, text=True, cwd=tmp_path)
        devices.append(device)
        assert device.stdout is not None
        return device.stdout.readline().strip()

    yield start
    for device in devices:
        device.kill()
        device.communicate()


@pytest.fixture
def head(emulate: Callable[..., str]) -> str:
    return "ping360:" + emulate("ping360", "--listen", "udp://127.0.0.1:0", "--rate", 1000)


def wait_until(holds: Callable[[], bool]) -> None:
    """At most a minute."""
    for _ in range(6000):
        if holds():
            return
        time.sleep(0.01)
    raise AssertionError("not within a minute")


def expect_map_of_record(program: Program, made: pingvox.OccupancyMap, log: Path) -> None:
    program("map", log, "-o", log.with_suffix(".bt"), "--resolution", 0.1, "--quiet")
    made.save(log.with_suffix(".live.bt"))
    assert log.with_suffix(".live.bt").read_bytes() == log.with_suffix(".bt").read_bytes()
    assert len(made) > 200


def test_map_is_that_of_the_recording_to_the_bit(program: Program, head: str, tmp_path: Path) -> None:
    with pingvox.LiveMapping(head, record=tmp_path / "dive.bin", **QUICK) as live:
        assert live.is_recording and live.recordings == [tmp_path / "dive.bin"]
        wait_until(lambda: live.status.beams >= 50)
        early = live.map
        leaves = len(early)
        wait_until(lambda: live.status.beams >= 100)
        assert len(early) == leaves  # a copy
    status = live.status
    assert status.mapped == status.beams == live.report["beams"] >= 100
    assert status.waiting == status.not_mapped == 0 and status.nav == [] and status.slam is None
    assert not live.wait(0)
    expect_map_of_record(program, live.map, tmp_path / "dive.bin")
    assert live.coverage["sweeps"] >= live.report["sweeps"] >= 4
    assert live.time > 0.0 and abs(live.since_1970 - time.time()) < 3600
    live.finish()  # once more


def test_events_are_objects_with_the_text_of_the_program(head: str) -> None:
    with pingvox.LiveMapping(head, **QUICK) as live:
        event = next(iter(live.events()))
        assert isinstance(event, live_event.Connected)
        assert event.device == head and event.error is None
        assert str(event) == f"{head}: connected"
        assert repr(event) == f"Connected(device={head!r})"
        assert live.take_events() == []
        wait_until(lambda: live.status.head.is_connected)
    assert list(live.events()) == []


def test_a_head_that_is_not_there_is_an_event() -> None:
    device = "ping360:udp://127.0.0.1:1"
    with pingvox.LiveMapping(device, **QUICK) as live:
        for event in live.events():
            assert isinstance(event, live_event.NotConnected)
            assert event.device == device and event.reason
            assert str(event) == f"{device}: not connected ({event.reason}); trying again"
            break
        head = live.status.head
        assert not head.is_connected and head.connections == 0 and head.problem
        assert "problem=" in repr(head)
    assert len(live.map) == 0


def test_a_replay_is_mapped_as_the_program_maps_it(program: Program, tank: Path, tmp_path: Path) -> None:
    program("map", tank, "-o", tmp_path / "map.ot", "--vote", "beam", "--quiet")
    with pingvox.LiveMapping(f"replay:{tank}@max", vote="beam") as live:
        list(live.events())  # until its end
        live.map.save(tmp_path / "live.ot")
        beams = live.take_beams()
    assert (tmp_path / "live.ot").read_bytes() == (tmp_path / "map.ot").read_bytes()
    assert live.since_1970 == 0.0 and live.path is None
    assert np.array_equal(beams.intensities, pingvox.open(tank).beams().intensities)
    assert len(live.take_beams()) == 0
    with pytest.raises(pingvox.Error, match="a replay cannot be changed"):
        live.drive()


def test_navigation_tells_where_the_vehicle_is(head: str, emulate: Callable[..., str], tmp_path: Path) -> None:
    with pingvox.LiveMapping(head, nav="mavlink:udp://127.0.0.1:0", record=tmp_path / "dives", **QUICK) as live:
        assert live.pose is None
        (device,) = live.status.nav
        assert device.kind == "mavlink" and device.vehicle == "" and device.recording_error is None
        emulate("mavlink", "--to", device.name.removeprefix("mavlink:"))
        chosen = next(event for event in live.events() if isinstance(event, live_event.SourcesChosen))
        assert str(chosen) == f"{device.name}: attitude of {chosen.attitude}, position of {chosen.position}"
        wait_until(lambda: live.status.mapped > 20)
        status = live.status
        assert (status.attitude, status.position) == (chosen.attitude, chosen.position)
        assert status.nav[0].messages > 0 and status.nav[0].vehicle
        assert live.pose is not None
        at, pose = live.pose
        assert at > 0.0 and pose.shape == (4, 4)
        assert np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3))
    assert sorted(path.suffix for path in live.recordings) == [".bin", ".tlog"]
    assert all(path.stat().st_size > 0 for path in live.recordings)


def test_slam_says_what_it_does(tank: Path) -> None:
    events: list[pingvox.LiveEvent] = []
    # The sonar alone does not tell how a head moves in this tank.
    with pytest.raises(pingvox.Error, match="motion cannot be estimated from the sonar"):
        with pingvox.LiveMapping(f"replay:{tank}@max", slam=True, resolution=0.1) as live:
            events.extend(live.events())
    chosen = events[0]
    assert isinstance(chosen, live_event.MotionChosen)
    assert (chosen.motion, chosen.velocity, chosen.heading, chosen.deviation) == ("sonar", "", "", None)
    assert str(chosen) == "slam: no velocity and no heading: motion from the sonar alone"
    slam = live.status.slam
    assert slam is not None and slam.motion == "sonar" and slam.located is None and slam.predicted is None
    assert live.path is None and live.pose is None
    assert live.status.not_mapped == 1000


def test_head_recording_and_map_can_be_changed_while_it_runs(program: Program, head: str, tmp_path: Path) -> None:
    with pingvox.LiveMapping(head, record=tmp_path / "dives", sector=(-90, 90), **QUICK) as live:
        wait_until(lambda: live.status.mapped > 10)
        live.end_recording()
        assert not live.is_recording
        live.drive(range=2, sector=None)
        live.take_beams()
        before = live.begin_new_map()
        assert len(before) > 0
        live.begin_recording()
        wait_until(lambda: live.status.beams > 60)
        beams = live.take_beams()
        assert len(live.recordings) == 2 and live.take_latency() >= 0.0
        with pytest.raises(pingvox.Error, match="drive: step: must be a multiple of 0.9 up to 18, is 1"):
            live.drive(step=1)
        with pytest.raises(pingvox.Error, match="drive: unknown option 'rnage': did you mean 'range'"):
            live.drive(rnage=1)  # type: ignore[call-arg]
    assert (beams.bin_lengths * beams.bins)[-1] == pytest.approx(2.0, rel=0.05)
    # All around, 18 degrees from one to the next: what was not given anew stays.
    assert len(np.unique(np.round(np.degrees(beams.bearings[-20:])))) == 20
    assert pingvox.open(live.recordings[1]).beams().skipped == 0


@pytest.mark.parametrize(
    ("device", "keywords", "args"),
    [
        ("ping360:udp://127.0.0.1:9", {"range": 1000}, ["--range=1000"]),
        ("ping360:udp://127.0.0.1:9", {"step": 1}, ["--step=1"]),
        ("ping360:udp://127.0.0.1:9", {"map": "x.bt"}, ["--map=x.bt"]),
        ("ping360:udp://127.0.0.1:9", {"nav": "serial"}, ["--nav=serial"]),
        ("ping360:udp://127.0.0.1:9", {"nav": "mavlink:udp://:0", "record": "x.tlog"},
         ["--nav=mavlink:udp://:0", "--record=x.tlog"]),
        ("replay:tank.csv", {"record": "x.bin"}, ["--record=x.bin"]),
        ("replay:tank.csv", {"range": 5}, ["--range=5"]),
        ("replay:nowhere.csv", {}, []),
    ],
)
def test_errors_are_those_of_the_program(
    program: Program, tank: Path, monkeypatch: pytest.MonkeyPatch, device: str, keywords: dict[str, Any], args: list[str]
) -> None:
    monkeypatch.chdir(tank.parent)
    expected = program.error("live", device, "-o", "error.bt", *args)
    with pytest.raises(pingvox.Error) as raised:
        pingvox.LiveMapping(device, **keywords)
    expected = re.sub("^live: ", "LiveMapping: ", re.sub("--([a-z])", r"\1", expected))
    assert str(raised.value) == expected if keywords else "nowhere.csv" in str(raised.value)


def test_usage_is_checked_before_a_device_is_opened(head: str, tmp_path: Path) -> None:
    with pytest.raises(pingvox.Error, match="LiveMapping: unknown option 'recrod': did you mean 'record'"):
        pingvox.LiveMapping(head, recrod="x")  # type: ignore[call-arg]
    with pytest.raises(pingvox.Error, match="LiveMapping: head: no such device 'sonar': must be ping360:udp://HOST:PORT"):
        pingvox.LiveMapping("sonar")
    with pytest.raises(TypeError):
        pingvox.LiveMapping()  # type: ignore[call-arg]
    (tmp_path / "dive.bin").write_bytes(b"of an earlier dive")
    with pytest.raises(pingvox.Error, match="dive.bin.*exists") as raised:
        pingvox.LiveMapping(head, record=tmp_path / "dive.bin")
    assert raised.value.code == "io"
    assert (tmp_path / "dive.bin").read_bytes() == b"of an earlier dive"


def test_what_is_raised_within_comes_out_and_the_run_ends(program: Program, head: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="enough"):
        with pingvox.LiveMapping(head, record=tmp_path / "dive.bin", **QUICK) as live:
            wait_until(lambda: live.status.beams >= 50)
            raise ValueError("enough")
    assert not live.wait(0)
    expect_map_of_record(program, live.map, tmp_path / "dive.bin")


def test_the_map_has_its_limit(head: str) -> None:
    with pytest.raises(pingvox.Error) as raised:
        with pingvox.LiveMapping(head, memory_limit="64K", **{**QUICK, "resolution": 0.01}) as live:
            failed = next(event for event in live.events() if isinstance(event, live_event.MappingFailed))
            assert failed.error.code == "limit" and str(failed) == str(failed.error)
            live.finish()
            raise failed.error
    assert raised.value.code == "limit"


def test_dropped_without_an_end_it_ends(head: str, tmp_path: Path) -> None:
    live = pingvox.LiveMapping(head, record=tmp_path / "dive.bin", **QUICK)
    wait_until(lambda: live.status.beams >= 20)
    del live
    size = (tmp_path / "dive.bin").stat().st_size
    time.sleep(0.2)
    assert (tmp_path / "dive.bin").stat().st_size == size


def test_threads_look_on_while_it_maps(head: str) -> None:
    errors: list[BaseException] = []

    def look(live: pingvox.LiveMapping) -> None:
        try:
            points = np.random.default_rng(1).uniform(-4, 4, (1000, 3))
            while live.wait(0.001):
                live.map.log_odds(points)
                # The report first: beams come meanwhile.
                assert live.report["beams"] <= live.status.beams
                live.take_events()
                live.take_beams()
        except BaseException as error:
            errors.append(error)

    with pingvox.LiveMapping(head, **QUICK) as live:
        threads = [threading.Thread(target=look, args=(live,)) for _ in range(3)]
        for thread in threads:
            thread.start()
        wait_until(lambda: live.status.mapped >= 200)
    for thread in threads:
        thread.join()
    assert not errors


@pytest.mark.parametrize("waits", ["for event in live.events(): pass", "live.wait(1000)", "while True: live.map"])
def test_ctrl_c_ends_it_and_keeps_all(program: Program, head: str, tmp_path: Path, waits: str) -> None:
    script = f"""
import pingvox
try:
    with pingvox.LiveMapping({head!r}, record="dive.bin", range=4, step=18, timeout=0.2, resolution=0.1) as live:
        {waits}
except KeyboardInterrupt:
    live.map.save("kept.bt")
    print("interrupted")
"""
    child = subprocess.Popen([sys.executable, "-c", script], cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    log = tmp_path / "dive.bin"
    try:
        wait_until(lambda: log.exists() and log.stat().st_size > 40_000)
        child.send_signal(signal.SIGINT)
        said, _ = child.communicate(timeout=60)
    finally:
        child.kill()
    assert said == "interrupted\n" and child.returncode == 0
    expect_map_of_record(program, pingvox.OccupancyMap.open(tmp_path / "kept.bt"), log)


def test_the_example_maps_until_ctrl_c(program: Program, head: str, tmp_path: Path) -> None:
    example = Path(os.environ["PINGVOX_SOURCE_DIR"]) / "examples" / "python" / "live.py"
    child = subprocess.Popen([sys.executable, str(example), head, "dive.bt"], cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout is not None
        said = child.stdout.readline() + child.stdout.readline()
        child.send_signal(signal.SIGINT)
        child.communicate(timeout=60)
    finally:
        child.kill()
    assert child.returncode == 0
    assert said.startswith(f"{head}: connected\n") and "occupied cells" in said
    assert len(list(tmp_path.glob("recordings/*"))) == 1
    assert pingvox.OccupancyMap.open(tmp_path / "dive.bt").info()["occupied_cells"] > 0


def test_events_of_the_module_are_those_of_the_header() -> None:
    header = Path(os.environ["PINGVOX_SOURCE_DIR"]) / "include" / "pingvox" / "live" / "live_event.hpp"
    structs = re.findall(r"^struct (\w+) \{", header.read_text(), re.MULTILINE)
    assert len(structs) > 20
    assert sorted(structs) == sorted(live_event.__all__)
    for name in structs:
        assert issubclass(getattr(live_event, name), pingvox.LiveEvent)


def test_waiting_takes_the_time_that_is_asked_for(head: str) -> None:
    with pingvox.LiveMapping(head, **QUICK) as live:
        before = time.monotonic()
        assert live.wait(0.2)
        assert time.monotonic() - before >= 0.2
        assert live.wait(-1) and not math.isnan(live.time)
