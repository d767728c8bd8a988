"""What the module makes of recordings is what the program makes of them."""

import copy
import multiprocessing
import pickle
import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pingvox
import pytest
from conftest import Program

COUNTS = ["beams", "sweeps", "echoes", "skipped", "cells_freed", "cells_hit", "threshold"]


def test_map_has_the_bytes_and_counts_of_the_program(program: Program, tank: Path) -> None:
    told = program.json("map", tank, "-o", "program.bt", "--resolution", 0.1)
    made = pingvox.open(tank).map(resolution=0.1)
    made.save(program.folder / "python.bt")
    assert (program.folder / "python.bt").read_bytes() == (program.folder / "program.bt").read_bytes()
    assert {name: made.report[name] for name in COUNTS} == {name: told[name] for name in COUNTS}
    assert made.report["skipped_for"] == told["skipped_for"]
    info = made.info()
    assert info == {name: told["map"][name] for name in info}


def test_skipped_is_the_sum_of_its_reasons(program: Program, tank: Path) -> None:
    lines = tank.read_text().splitlines(keepends=True)
    (program.folder / "damaged.csv").write_text("".join(lines[:500] + ["damaged\n"] * 3 + lines[500:]))
    told = program.json("map", "damaged.csv", "-o", "damaged.bt", "--resolution", 0.1)
    report = pingvox.open(program.folder / "damaged.csv").map(resolution=0.1).report
    assert report["skipped_for"] == told["skipped_for"]
    assert report["skipped"] == sum(report["skipped_for"].values()) > 0
    assert any("damaged.csv: skipped 3 damaged records, the first: " in text for text in report["warnings"])


def test_warnings_are_in_the_report(tank: Path) -> None:
    recording = pingvox.open(tank)
    assert recording.map(resolution=0.1).report["warnings"] == []
    times = recording.beams().times
    middle = pingvox.Trajectory([times[0], times[499]], np.repeat(np.eye(4)[None], 2, axis=0))
    (warning,) = recording.map(middle, resolution=0.1).report["warnings"]
    assert "tank.csv: skipped 500 of 1000 beams outside the time of the poses" in warning
    assert "(poses must cover the log" in warning


def test_warnings_are_those_of_the_program(program: Program, tank: Path) -> None:
    """A path in milliseconds that never turns."""
    times = pingvox.open(tank).beams().times
    path = [f"{1000 * time:.3f} {0.01 * i:.3f} 0 0 0 0 0 1" for i, time in enumerate(times)]
    (program.folder / "odd.tum").write_text("\n".join(path))
    told = program.warnings("map", tank, "--poses", "odd.tum", "-o", "odd.bt", "--resolution", 0.1)
    found = pingvox.open(tank, poses=program.folder / "odd.tum").map(resolution=0.1).report["warnings"]
    assert len(found) == 2
    assert [text.removeprefix(f"{program.folder}/") for text in found] == told


def test_maps_of_recordings_are_copied_and_pickled_whole(tank: Path, tmp_path: Path) -> None:
    made = pingvox.open(tank).map(resolution=0.1)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        passed_on = pool.apply_async(copy.copy, (made,)).get(timeout=300)
    made.save(tmp_path / "made.pvx")
    for one in (made.copy(), copy.copy(made), copy.deepcopy(made), pickle.loads(pickle.dumps(made)), passed_on):
        assert isinstance(one, pingvox.RecordingMap)
        assert one.report == made.report
        assert np.array_equal(one.trajectory.matrices, made.trajectory.matrices)
        one.save(tmp_path / "copy.pvx")
        assert (tmp_path / "copy.pvx").read_bytes() == (tmp_path / "made.pvx").read_bytes()
        assert repr(one) == repr(made) == f"<pingvox.RecordingMap of 0.1 m, {len(made)} leaves>"
    with pytest.raises(TypeError, match="Recording.map"):
        pingvox.RecordingMap()


def test_trajectories_are_copied_and_pickled() -> None:
    poses = np.repeat(np.eye(4)[None], 3, axis=0)
    poses[:, 0, 3] = [0, 0.1, 7]
    path = pingvox.Trajectory([0, 1, 5], poses, longest_step=2)
    for one in (copy.copy(path), copy.deepcopy(path), pickle.loads(pickle.dumps(path))):
        assert np.array_equal(one.times, path.times) and np.array_equal(one.matrices, path.matrices)
        assert one.gaps == 1
        assert np.array_equal(one.at([0.3, 3]), path.at([0.3, 3]), equal_nan=True)
    for step in (-1, np.nan):
        with pytest.raises(pingvox.Error, match="longest_step: must be 0 or more"):
            pingvox.Trajectory([0, 1, 5], poses, longest_step=step)


def test_a_vehicle_that_stands_still_does_so_when_pickled(tank: Path) -> None:
    path = pingvox.open(tank).path()
    assert not np.isnan(pickle.loads(pickle.dumps(path)).at([-1e6, 1e6])).any()


def test_mounts_may_be_arrays(tank: Path) -> None:
    mount = [0.4, 0, -0.2, 180, 0, 10]
    of_list = pingvox.open(tank, mount=mount).map(resolution=0.1)
    of_array = pingvox.open(tank, mount=np.array(mount)).map(resolution=0.1)
    assert np.array_equal(of_list.leaves().centres, of_array.leaves().centres)


@pytest.mark.parametrize("keywords", [{"topic": "nope"}, {"origin": (1, 2, 3)}])
def test_options_of_other_logs_are_refused(tank: Path, keywords: dict[str, object]) -> None:
    with pytest.raises(pingvox.Error, match=f"{next(iter(keywords))}: has no effect") as raised:
        pingvox.open(tank, **keywords)  # type: ignore[arg-type]
    assert raised.value.code == "bad_option"


def test_options_do_what_they_do_in_the_program(program: Program, tank: Path) -> None:
    program("map", tank, "-o", "options.ot", "--resolution", 0.07, "--beam", "fan", "--beam-width", 4.5, "--mount",
            "0.4,0,-0.2,180,0,10", "--clamp", "0.1,0.9", "--vote", "beam", "--detect", "cfar", "--cfar", "ca", "--threshold",
            40, "--sound-speed", 1480, "--max-range", 4, "--cut-depth", 15, "--quiet")
    recording = pingvox.open(str(tank), mount=(0.4, 0, -0.2, 180, 0, 10), sound_speed=1480, beam_width=np.float32(4.5))
    made = recording.map(resolution=0.07, beam="fan", clamp=[0.1, 0.9], vote="beam", detect="cfar", cfar="ca", threshold=40,
                         max_range=4, cut_depth=15)
    made.save(program.folder / "python.ot")
    assert (program.folder / "python.ot").read_bytes() == (program.folder / "options.ot").read_bytes()


def test_slam_has_the_trajectory_calibration_and_map_of_the_program(program: Program, dive: tuple[Path, Path]) -> None:
    log, nav = dive
    told = program.json("slam", log, "--nav", nav, "-o", "program.tum", "--map", "slam.bt", "--resolution", 0.2,
                        "--calibration", "program.toml")
    found = pingvox.open(log, nav=nav).slam()
    found.trajectory.save(program.folder / "python.tum")
    assert (program.folder / "python.tum").read_bytes() == (program.folder / "program.tum").read_bytes()
    assert found.calibration == (program.folder / "program.toml").read_text()
    made = found.map(resolution=0.2)
    made.save(program.folder / "python_slam.bt")
    assert (program.folder / "python_slam.bt").read_bytes() == (program.folder / "slam.bt").read_bytes()
    assert found.report["poses"] == told["poses"] == len(found.trajectory)
    assert found.report["sweeps"] == told["sweeps"]
    times, covariances = found.covariances
    assert covariances.shape == (len(times), 3, 3)


def test_locate_finds_the_trajectory_of_the_program(program: Program, tank: Path) -> None:
    program("map", tank, "-o", "known.bt", "--quiet")
    program("locate", tank, "--map", "known.bt", "-o", "located.tum", "--seed", 3, "--quiet")
    shares: list[float] = []
    found = pingvox.open(tank).locate(pingvox.OccupancyMap.open(program.folder / "known.bt"), seed=3, progress=shares.append)
    found.trajectory.save(program.folder / "python_located.tum")
    assert (program.folder / "python_located.tum").read_bytes() == (program.folder / "located.tum").read_bytes()
    assert len(found.known) == len(found.trajectory)
    assert found.hypotheses[0]["weight"] > 0.9
    assert shares == sorted(shares)


def test_evaluate_counts_what_the_program_counts(program: Program, tank: Path) -> None:
    told = program.json("evaluate", tank, "--folds", 3, "--resolution", 0.1)
    found = pingvox.open(tank).evaluate(folds=3, resolution=0.1)
    assert found["echoes"] == told["echoes"]
    assert found["folds"] == told["folds"]
    # The program tells shares.
    assert found["judged"] / found["beams"] == pytest.approx(told["judged"], abs=1e-6)
    for name in ("within_cell", "too_early", "from_free"):
        assert found[name] / found["judged"] == pytest.approx(told[name], abs=1e-6)
    assert found["coverage"] == pytest.approx(told["coverage"], abs=1e-6)
    assert found["verdict"] == told["verdict"]


def test_path_of_navigation_is_a_trajectory(dive: tuple[Path, Path]) -> None:
    log, nav = dive
    recording = pingvox.open([log], nav=[nav], nav_offset=0)
    assert recording.nav_offset == 0.0
    path = recording.path()
    middle = 0.5 * (path.times[0] + path.times[-1])
    assert path.at([path.times[0] - 1.0, middle])[:, 3, 3].tolist()[1] == 1.0
    assert np.isnan(path.at([path.times[0] - 1.0])).all()
    again = pingvox.Trajectory(path.times, path.matrices)
    assert np.allclose(again.at([middle]), path.at([middle]))
    assert recording.map(again, resolution=0.5).trajectory.times.tolist() == path.times.tolist()


@pytest.mark.parametrize(
    ("keywords", "args"),
    [
        ({"resolution": -1}, ["--resolution=-1"]),
        ({"detect": "rize"}, ["--detect=rize"]),
        ({"clamp": (0.5,)}, ["--clamp=0.5"]),
        ({"cfar": "ca"}, ["--cfar=ca"]),
        ({"cut_depth": 17}, ["--cut-depth=17"]),
        ({"kernel": 4}, ["--kernel=4"]),
        ({"ray": "dda", "beam": "cone"}, ["--ray=dda", "--beam=cone"]),
    ],
)
def test_errors_are_those_of_the_program(
    program: Program, tank: Path, keywords: dict[str, object], args: list[str]
) -> None:
    expected = program.error("map", tank, "-o", "error.bt", *args)
    with pytest.raises(pingvox.Error) as raised:
        pingvox.open(tank).map(**keywords)  # type: ignore[arg-type]
    # Keywords are named without dashes.
    names = [arg.split("=")[0] for arg in args] + ["--detect", "--occupied"]
    for name in names:
        expected = expected.replace(name, name.removeprefix("--").replace("-", "_"))
    assert str(raised.value) == expected
    assert raised.value.code == "bad_option"


def test_unknown_keywords_name_the_nearest(tank: Path) -> None:
    with pytest.raises(pingvox.Error, match="map: unknown option 'resolutoin'.*resolution"):
        pingvox.open(tank).map(resolutoin=0.1)  # type: ignore[call-arg]
    with pytest.raises(pingvox.Error, match="open: unknown option 'naw'.*nav"):
        pingvox.open(tank, naw="x")  # type: ignore[call-arg]


def test_files_that_are_missing_or_broken_are_errors(program: Program, tank: Path) -> None:
    with pytest.raises(pingvox.Error, match="nowhere.bin") as raised:
        pingvox.open("nowhere.bin").map()
    assert raised.value.code == "io"
    broken = program.folder / "broken.bt"
    broken.write_bytes(b"# Octomap OcTree binary file\nid OcTree\nsize 3\nres 0.1\ndata\n\0\0")
    with pytest.raises(pingvox.Error) as raised:
        pingvox.OccupancyMap.open(broken)
    assert raised.value.code == "corrupt"
    assert "broken.bt" in str(raised.value)
    noise = program.folder / "noise.bin"
    noise.write_bytes(bytes(range(256)) * 20)
    with pytest.raises(pingvox.Error):
        pingvox.open(noise).map()


def test_exceptions_of_callbacks_come_through(tank: Path) -> None:
    def stop(beams: int) -> None:
        raise ValueError(f"enough: {beams}")

    recording = pingvox.open([tank] * 200)
    with pytest.raises(ValueError, match="enough"):
        recording.map(progress=stop, resolution=0.02)


@pytest.mark.parametrize("call", ["map", "slam", "locate", "evaluate", "echoes"])
def test_ctrl_c_ends_long_calls(program: Program, tank: Path, dive: tuple[Path, Path], call: str) -> None:
    """Whichever comes first: the signal ends the call, or the call was done before it."""
    log, nav = dive
    recording = pingvox.open([tank] * 100) if call in ("map", "evaluate") else pingvox.open(log, nav=nav)
    known = pingvox.open(tank).map()
    calls: dict[str, Callable[[], object]] = {
        "map": lambda: recording.map(resolution=0.02),
        "slam": lambda: [recording.slam() for _ in range(1000)],
        "locate": lambda: [recording.locate(known) for _ in range(1000)],
        "evaluate": lambda: recording.evaluate(resolution=0.02),
        "echoes": lambda: [recording.beams().echoes() for _ in range(100_000)],
    }
    threading.Timer(0.3, lambda: signal.raise_signal(signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        calls[call]()
        time.sleep(60)  # where the call was quicker than the signal


def test_other_threads_run_meanwhile(tank: Path) -> None:
    recording = pingvox.open([tank] * 30)
    counted = 0
    done = threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted
    recording.map(resolution=0.05)
    during = counted - before
    done.set()
    thread.join()
    assert during > 1
