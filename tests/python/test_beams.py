"""Beams, sweeps, filters, detectors and the mapper."""

import csv
import gc
import sys
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pingvox
import pytest
from conftest import Program


def test_beams_are_those_of_the_log(tank: Path) -> None:
    beams = pingvox.open(tank).beams()
    assert len(beams) == 1000
    assert beams.intensities.shape == (1000, 399)
    assert beams.bins.tolist() == [399] * 1000
    assert (np.diff(beams.times) > 0).all()
    assert ((beams.bearings >= 0) & (beams.bearings < 2 * np.pi)).all()
    assert np.allclose(beams.bin_lengths, 0.0125)
    assert beams.skipped == 0 and beams.note == ""
    assert np.array_equal(beams[-1].intensities, beams.intensities[-1])
    with pytest.raises(IndexError):
        beams[1000]


def test_beams_are_a_sequence(tank: Path) -> None:
    beams = pingvox.open(tank).beams()
    some = beams[10:2:-3]
    assert isinstance(some, pingvox.Beams)
    assert some.times.tolist() == [beams[i].time for i in (10, 7, 4)]
    assert [beam.time for beam in some] == some.times.tolist()
    assert repr(some[0]).startswith("<pingvox.Beam at ") and repr(some) == "<pingvox.Beams, 3>"
    sweep = beams.sweeps()[0]
    assert repr(sweep) == "<pingvox.Sweep of 200 beams, turn>"
    assert repr(sweep.echoes()) == f"<pingvox.Echoes of 200 beams, {sweep.echoes().found.sum()} found>"
    assert "pingvox::" not in (pingvox.Sweep.beams.__doc__ or "")


def test_views_share_memory_and_keep_it_alive(tank: Path) -> None:
    beams = pingvox.open(tank).beams()
    beam = beams[7]
    first, second = beam.intensities, beam.intensities
    assert np.shares_memory(first, second)
    assert not first.flags.writeable
    with pytest.raises(ValueError):
        first[0] = 1
    sweep = beams.sweeps()[0]
    image = sweep.image
    assert np.shares_memory(image, sweep.image)
    kept, kept_image = first.copy(), image.copy()
    del beams, beam, sweep, second
    gc.collect()
    assert np.array_equal(first, kept) and np.array_equal(image, kept_image)


def test_views_are_freed(tank: Path) -> None:
    beams = pingvox.open(tank).beams()
    before = sys.getrefcount(beams)
    views = [beams[i].intensities for i in range(100)] + [sweep.image for sweep in beams.sweeps()]
    assert len(views) > 100
    del views
    gc.collect()
    assert sys.getrefcount(beams) == before


def test_sweeps_cover_the_beams(tank: Path) -> None:
    beams = pingvox.open(tank).beams()
    sweeps = beams.sweeps()
    assert sum(len(sweep) for sweep in sweeps) == len(beams)
    assert [sweep.extent for sweep in sweeps[:4]] == ["turn"] * 4
    assert np.array_equal(np.concatenate([sweep.image for sweep in sweeps]), beams.intensities)


def test_echoes_are_those_of_the_program(program: Program, tank: Path) -> None:
    program("convert", tank, "-o", "echoes.csv", "--echoes", "--quiet")
    with open(program.folder / "echoes.csv", newline="", encoding="ascii") as file:
        lines = [line for line in csv.reader(file) if line and not line[0].startswith("#")]
    echoes = pingvox.open(tank).beams().echoes()
    assert len(echoes) == 1000
    assert echoes.found.sum() == len([line for line in lines if line[0][:1].isdigit()])
    assert np.isnan(echoes.ranges[~echoes.found]).all()
    assert (echoes.first[echoes.found] <= echoes.peak[echoes.found]).all()
    by_sweep = [sweep.echoes() for sweep in pingvox.open(tank).beams().sweeps()]
    assert np.array_equal(np.concatenate([one.ranges for one in by_sweep]), echoes.ranges, equal_nan=True)
    cfar = pingvox.open(tank).beams().echoes(detect="cfar", min_range="auto")
    assert 0 < cfar.found.sum() and not np.array_equal(cfar.ranges, echoes.ranges, equal_nan=True)


def test_filters(tank: Path) -> None:
    sweep = pingvox.open(tank).beams().sweeps()[0]
    assert np.array_equal(sweep.filtered(filter="none"), sweep.image)
    smooth = sweep.filtered(kernel=11, sigma=2.3)
    assert smooth.shape == sweep.image.shape and not np.array_equal(smooth, sweep.image)
    assert np.array_equal(pingvox.filter_image(sweep.image, kernel=11, sigma=2.3), smooth)
    assert pingvox.filter_image(np.zeros((0, 5), dtype=np.uint8)).size == 0
    with pytest.raises(pingvox.Error, match="filter_image: kernel: must be odd"):
        pingvox.filter_image(sweep.image, kernel=4)


def test_mapper_makes_the_map_of_the_program(program: Program, tank: Path) -> None:
    program("map", tank, "-o", "whole.bt", "--resolution", 0.1, "--quiet")
    beams = pingvox.open(tank).beams()
    made = pingvox.OccupancyMap(resolution=0.1)
    mapper = pingvox.BeamMapper(made)
    mapper.add_beams(beams)
    mapper.finish()
    made.save(program.folder / "mapper.bt")
    assert (program.folder / "mapper.bt").read_bytes() == (program.folder / "whole.bt").read_bytes()
    assert mapper.report["beams"] == 1000

    single = pingvox.BeamMapper(pingvox.OccupancyMap(resolution=0.1))
    for i in range(len(beams)):
        beam = beams[i]
        single.add(beam.time, beam.bearing, beam.bin_length, beam.intensities, np.eye(4))
    single.finish()
    # The mapper keeps its map alive.
    single.map.save(program.folder / "single.bt")
    assert (program.folder / "single.bt").read_bytes() == (program.folder / "whole.bt").read_bytes()


def test_mapper_leaves_out_what_has_no_pose(tank: Path) -> None:
    beams = pingvox.open(tank).beams()
    still = np.repeat(np.eye(4)[None], 2, axis=0)
    middle = beams.times[499]
    mapper = pingvox.BeamMapper(pingvox.OccupancyMap(resolution=0.1), vote="beam")
    mapper.add_beams(beams, pingvox.Trajectory([beams.times[0], middle], still))
    mapper.finish()
    assert mapper.report["skipped_for"]["no_pose"] == 500
    with pytest.raises(pingvox.Error, match="pose: is not a rigid transform"):
        mapper.add(0.0, 0.0, 0.01, np.zeros(10, dtype=np.uint8), np.ones((4, 4)))


def test_beams_of_arrays() -> None:
    intensities = np.zeros((200, 300), dtype=np.uint8)
    intensities[:, 150:160] = 200
    bearings = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    beams = pingvox.Beams(np.arange(200) * 0.05, bearings, 0.02, intensities)
    echoes = beams.echoes(min_range=0.5)
    assert echoes.found.all()
    assert np.abs(echoes.ranges - 3.0).max() < 0.2
    with pytest.raises(pingvox.Error, match="beam 0"):
        pingvox.Beams([0.0], [np.nan], 0.02, intensities[:1])
    with pytest.raises(pingvox.Error, match="shape"):
        pingvox.Beams([0.0], [0.0], 0.02, intensities)
    with pytest.raises(pingvox.Error, match=r"bins\[1\]: must be at most 300, is 301"):
        pingvox.Beams([0.0, 1.0], [0.0, 1.0], 0.02, intensities[:2], bins=[300, 301])


@pytest.mark.parametrize("dtype", [np.uint16, np.int64, np.float32, np.float64, object])
def test_intensities_may_be_whole_numbers_of_any_type(dtype: type) -> None:
    intensities = np.arange(0, 256).astype(dtype)
    assert pingvox.Beams([0], [0], 0.02, intensities[None])[0].intensities.tolist() == list(range(256))
    assert pingvox.filter_image(intensities[None], filter="none").tolist() == [list(range(256))]


@pytest.mark.parametrize("wrong", [[4000], [-1], [0.5], [np.nan], [np.inf], ["1"]])
def test_intensities_out_of_range_are_errors(wrong: list[object]) -> None:
    mapper = pingvox.BeamMapper(pingvox.OccupancyMap())
    intensities: npt.NDArray[Any] = np.array([*wrong, *wrong])
    for call in (
        lambda: pingvox.Beams([0], [0], 0.02, intensities[None]),
        lambda: mapper.add(0, 0, 0.02, intensities, np.eye(4)),
    ):
        with pytest.raises(pingvox.Error, match="intensities: must be"):
            call()
    with pytest.raises(pingvox.Error, match="image: must be"):
        pingvox.filter_image(intensities[None])


def test_a_mapper_needs_a_map() -> None:
    with pytest.raises(TypeError):
        pingvox.BeamMapper(None)  # type: ignore[arg-type]
