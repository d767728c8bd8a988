"""Maps: arrays in, arrays out."""

import copy
import gc
import pickle
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pingvox
import pytest
from pingvox import FREE, OCCUPIED, UNKNOWN


def wall() -> pingvox.OccupancyMap:
    """A wall at x = 2 m, seen from the origin."""
    made = pingvox.OccupancyMap(resolution=0.1)
    y, z = np.meshgrid(np.arange(-1, 1, 0.05), np.arange(-0.5, 0.5, 0.05))
    made.insert_points(np.stack([np.full(y.size, 2.05), y.ravel(), z.ravel()], axis=1), (0, 0, 0))
    return made


def test_insert_and_query() -> None:
    made = wall()
    points = np.array([[2.05, 0, 0], [1, 0, 0], [3, 0, 0], [1e9, 0, 0], [np.nan, 0, 0]])
    assert made.occupancy(points).tolist() == [OCCUPIED, FREE, UNKNOWN, UNKNOWN, UNKNOWN]
    log_odds = made.log_odds(points)
    assert log_odds.dtype == np.float32
    assert np.allclose(log_odds[:2], [np.log(0.7 / 0.3), np.log(0.4 / 0.6)])
    assert np.isnan(log_odds[2:]).all()
    assert np.allclose(made.probability(points)[:2], [0.7, 0.4])
    # Points of lists, of other types, and not one behind the other in memory.
    assert made.occupancy([[2.05, 0.0, 0.0]]).tolist() == [OCCUPIED]
    assert made.occupancy(points.astype(np.float32)[::2]).tolist() == [OCCUPIED, UNKNOWN, UNKNOWN]
    assert made.occupancy(np.asfortranarray(points))[0] == OCCUPIED


def test_keys_are_cells() -> None:
    made = wall()
    points = np.array([[2.05, 0.02, 0.02], [0.0, 0.0, 0.0]])
    keys, inside = made.keys(points)
    assert keys.dtype == np.uint16
    assert inside.all()
    assert keys[1].tolist() == [32768] * 3
    assert np.array_equal(made.log_odds(keys=keys), made.log_odds(points))
    assert np.array_equal(made.log_odds(keys=keys.astype(np.int64)), made.log_odds(points))
    for strided in (keys.astype(np.int64)[::-1], np.asfortranarray(keys.astype(np.int32))[::-1], keys[::-1]):
        assert np.array_equal(made.log_odds(keys=strided), made.log_odds(points)[::-1])
    assert np.abs(made.centres(keys) - points).max() <= 0.05 + 1e-9
    assert not made.keys([[1e9, 0, 0]])[1].any()
    with pytest.raises(pingvox.Error, match=r"keys\[1\]: is outside of the lattice: must be in 0..65535"):
        made.log_odds(keys=[[1, 2, 3], [1, 2, -1]])
    with pytest.raises(pingvox.Error, match="whole numbers"):
        made.log_odds(keys=[[0.5, 1, 2]])
    deep = pingvox.OccupancyMap(resolution=0.1, depth=20)
    assert deep.keys(points)[0].dtype == np.uint32
    with pytest.raises(pingvox.Error, match="0..1048575"):
        deep.log_odds(keys=np.array([[1 << 20, 0, 0]], dtype=np.uint32))


def test_update_adds_evidence() -> None:
    made = pingvox.OccupancyMap(resolution=0.5)
    made.update([[0.1, 0.1, 0.1], [0.1, 0.1, 0.1]], probability=0.7)
    keys, _ = made.keys([[0.1, 0.1, 0.1]])
    assert np.allclose(made.log_odds(keys=keys), 2 * np.log(0.7 / 0.3))
    made.update(keys=keys, probability=0.4)
    assert np.allclose(made.log_odds(keys=keys), 2 * np.log(0.7 / 0.3) + np.log(0.4 / 0.6))


def test_rays_and_nearest() -> None:
    made = wall()
    ends = made.cast_rays([0, 0, 0], [[1, 0, 0], [-1, 0, 0], [2, 0, 0]], 10)
    assert ends.occupancy.tolist() == [OCCUPIED, FREE, OCCUPIED]
    assert np.allclose(ends.ranges, [2, 10, 2])
    assert np.allclose(ends.points[0], [2, 0, 0])
    blocked = made.cast_rays([0, 0, 0], [-1, 0, 0], 10, unknown="block")
    assert blocked.occupancy.tolist() == [UNKNOWN]
    cells = made.nearest([[0, 0, 0], [5, 0, 0]])
    assert np.allclose(cells.ranges, [2, 2.9])
    assert np.isinf(made.nearest([[0, 0, 0]], max_range=1).ranges).all()
    with pytest.raises(pingvox.Error, match=r"directions\[0\]"):
        made.cast_rays([0, 0, 0], [0, 0, 0], 1)
    with pytest.raises(pingvox.Error, match=r"directions\[1\]"):
        made.cast_rays([0, 0, 0], [[1, 0, 0], [np.nan, 0, 0]], 1)


@pytest.mark.parametrize("length", [5e-324, 1e-200, 1e-160, 1e160, 1e308])
def test_rays_take_directions_of_any_length(length: float) -> None:
    ends = wall().cast_rays([0, 0, 0], [length, 0, 0], 5)
    assert ends.occupancy.tolist() == [OCCUPIED]
    assert np.allclose(ends.points, [[2, 0, 0]])


def test_look_ups_of_nan_are_nan_and_of_nothing_are_empty() -> None:
    made = wall()
    cells = made.nearest([[0, 0, 0], [np.nan, 0, 0], [np.inf, 0, 0]])
    assert np.isnan(cells.ranges).tolist() == [False, True, True]
    assert np.isnan(cells.points[1:]).all()
    nothing = np.zeros((0, 3))
    assert len(made.cast_rays([0, 0, 0], nothing, 5)) == len(made.cast_rays(nothing, [1, 0, 0], 5)) == 0
    assert len(made.nearest(nothing)) == len(made.occupancy(nothing)) == 0
    empty = pingvox.OccupancyMap()
    assert empty.slice().occupancy.shape == (0, 0)
    assert made.slice(50, 60).occupancy.shape == (0, 0)


def test_rays_end_at_the_border_of_the_map() -> None:
    made = pingvox.OccupancyMap(resolution=0.1, depth=5)  # 1.6 m in each direction
    ends = made.cast_rays([[0, 0, 0], [-2, 0, 0]], [1, 0, 0], 100)
    assert ends.occupancy.tolist() == [FREE, UNKNOWN]
    assert np.allclose(ends.ranges, [1.6, 0])


def test_leaves_tell_the_whole_map() -> None:
    made = wall()
    leaves = made.leaves()
    assert len(leaves) == len(made) == made.info()["leaves"]
    volume = leaves.sizes**3
    cell = made.resolution**3
    for occupancy, name in ((OCCUPIED, "occupied_cells"), (FREE, "free_cells")):
        assert round(volume[leaves.occupancy == occupancy].sum() / cell) == made.info()[name]
    assert np.array_equal(made.log_odds(leaves.centres), leaves.log_odds)
    bounds = made.bounds
    assert bounds is not None
    assert (leaves.centres > bounds[0]).all() and (leaves.centres < bounds[1]).all()
    part = made.leaves(box=[[1.5, -0.2, -0.2], [2.2, 0.2, 0.2]])
    assert 0 < len(part) < len(leaves)
    assert made.leaves(max_depth=10).sizes.min() > made.resolution
    assert pingvox.OccupancyMap().bounds is None
    assert len(pingvox.OccupancyMap().leaves()) == 0


def test_slice_is_an_image() -> None:
    made = wall()
    seen = made.slice(-0.2, 0.2)
    x_min, x_max, y_min, y_max = seen.extent
    rows, columns = seen.occupancy.shape
    assert columns == round((x_max - x_min) / 0.1) and rows == round((y_max - y_min) / 0.1)
    assert (seen.occupancy[:, -1] == OCCUPIED).any()


def test_arrays_outlive_the_map() -> None:
    made = wall()
    leaves = made.leaves()
    centres, before = leaves.centres, leaves.centres.copy()
    del made, leaves
    gc.collect()
    other = [wall() for _ in range(3)]
    assert np.array_equal(centres, before)
    assert len(other) == 3


def test_copies_are_independent(tmp_path: Path) -> None:
    made = wall()
    copies = [made.copy(), copy.copy(made), copy.deepcopy(made), pickle.loads(pickle.dumps(made))]
    made.save(tmp_path / "before.ot")
    made.clear()
    assert len(made) == 0
    for one in copies:
        one.save(tmp_path / "copy.ot")
        assert (tmp_path / "copy.ot").read_bytes() == (tmp_path / "before.ot").read_bytes()


def test_pickles_keep_the_memory_limit() -> None:
    limited = pickle.loads(pickle.dumps(pingvox.OccupancyMap(resolution=0.001, memory_limit="1M")))
    with pytest.raises(pingvox.Error) as raised:
        limited.insert_points(np.random.default_rng(1).uniform(-5, 5, (2000, 3)), [0, 0, 0])
    assert raised.value.code == "limit"


@pytest.mark.parametrize("use", [len, repr, pingvox.OccupancyMap.info, lambda one: one.occupancy([0, 0, 0])])
def test_a_map_without_init_is_an_error(use: Callable[[pingvox.OccupancyMap], object]) -> None:
    with pytest.raises(pingvox.Error, match="its __init__ was not called"):
        use(pingvox.OccupancyMap.__new__(pingvox.OccupancyMap))


def test_merge_adds() -> None:
    made = wall()
    made.merge(wall())
    assert np.allclose(made.log_odds([[2.05, 0, 0]]), 2 * np.log(0.7 / 0.3))
    made.merge(made)
    with pytest.raises(pingvox.Error):
        made.merge(pingvox.OccupancyMap(resolution=0.2))


def test_save_and_open(tmp_path: Path) -> None:
    made = wall()
    for suffix in (".bt", ".ot", ".pvx"):
        file = tmp_path / f"map{suffix}"
        made.save(file)
        assert pingvox.OccupancyMap.open(file).info()["occupied_cells"] == made.info()["occupied_cells"]
    with pytest.raises(pingvox.Error, match="map.txt"):
        made.save(tmp_path / "map.txt")


def test_thresholds_when_a_map_is_opened(tmp_path: Path) -> None:
    made = wall()
    made.save(tmp_path / "map.ot")
    points = [[2.05, 0, 0], [1, 0, 0]]  # of probability 0.7 and 0.4
    strict = pingvox.OccupancyMap.open(tmp_path / "map.ot", occupied=0.8, free=0.3)
    assert strict.occupancy(points).tolist() == [UNKNOWN, UNKNOWN]
    assert pingvox.OccupancyMap.open(tmp_path / "map.ot", free=0.5).occupancy(points).tolist() == [OCCUPIED, FREE]
    with pytest.raises(pingvox.Error, match="free: must be at most occupied"):
        pingvox.OccupancyMap.open(tmp_path / "map.ot", occupied=0.3, free=0.4)


@pytest.mark.parametrize("points", [[1, 2], [[1, 2]], np.zeros((2, 2, 3)), np.zeros(())])
def test_wrong_shapes_are_errors(points: object) -> None:
    with pytest.raises(pingvox.Error, match=r"points: must be an array of shape \(N, 3\)"):
        wall().occupancy(points)  # type: ignore[arg-type]


def test_messages_name_the_shape() -> None:
    made = wall()
    origins: list[list[Any]] = [[0, 0], [[0, 0, 0], [5, 5, 5]], [[0, 0, 0]]]
    for origin in origins:
        with pytest.raises(pingvox.Error, match=r"origin: must be an array of shape \(3,\)"):
            made.insert_points([[1, 0, 0], [6, 5, 5]], origin)
    boxes: list[list[Any]] = [[0, 0, 0, 1, 1, 1], [[0, 0, 0]]]
    for box in boxes:
        with pytest.raises(pingvox.Error, match=r"box: must be an array of shape \(2, 3\)"):
            made.leaves(box=box)
    with pytest.raises(pingvox.Error, match=r"points: must be an array of shape \(N, 3\)"):
        made.insert_points([1, 2], [0, 0, 0])


def test_values_that_mean_nothing_are_errors() -> None:
    made = wall()
    before = made.info()
    for origin in ([np.nan, 0, 0], [np.inf, 0, 0]):
        with pytest.raises(pingvox.Error, match="origin: must be finite"):
            made.insert_points([[1, 0, 0]], origin)
    assert made.info() == before
    for points in (np.ones((2, 3)) > 0, [["1", "2", "3"]], None):
        with pytest.raises(pingvox.Error, match="points"):
            made.insert_points(points, [0, 0, 0])  # type: ignore[arg-type]
    with pytest.raises(pingvox.Error, match="points: must be an array of numbers, of shape .* bool"):
        made.occupancy(np.ones((2, 3)) > 0)
    for box in (np.array([[1, 1, 1], [0, 0, 0]]), np.array([[0, 0, np.nan], [1, 1, 1]])):
        with pytest.raises(pingvox.Error, match="box: must be the least and the greatest corner"):
            made.leaves(box=box)


def test_one_point_is_inserted() -> None:
    one, row = pingvox.OccupancyMap(), pingvox.OccupancyMap()
    assert one.insert_points([1, 2, 3], [0, 0, 0]) == row.insert_points([[1, 2, 3]], [0, 0, 0])
    assert one.insert_points(np.zeros((0, 3)), [0, 0, 0])["cells_hit"] == 0


@pytest.mark.parametrize("as_array", [np.float64, np.array, lambda number: np.array([number])])
def test_options_may_be_arrays(as_array: Callable[[float], object]) -> None:
    assert pingvox.OccupancyMap(resolution=as_array(1.7)).resolution == 1.7  # type: ignore[arg-type]
    short, long = pingvox.OccupancyMap(), pingvox.OccupancyMap()
    short.insert_points([3, 0, 0], [0, 0, 0], max_range=as_array(1.7))  # type: ignore[arg-type]
    long.insert_points([3, 0, 0], [0, 0, 0], max_range=1.7)
    assert short.info() == long.info()


@pytest.mark.parametrize(
    "clamp", [np.array([0.2, 0.6]), (np.array(0.2), np.array(0.6)), np.array([[0.2], [0.6]]), [np.float32(0.2), 0.6]]
)
def test_options_of_several_numbers_may_be_arrays(clamp: object) -> None:
    made = pingvox.OccupancyMap(resolution=1, clamp=clamp)  # type: ignore[arg-type]
    made.update([0, 0, 0], probability=0.9)
    assert np.allclose(made.probability([0, 0, 0]), 0.6)


def test_options_are_checked() -> None:
    with pytest.raises(pingvox.Error, match="OccupancyMap: unknown option 'resolutio'.*resolution"):
        pingvox.OccupancyMap(resolutio=0.1)  # type: ignore[call-arg]
    with pytest.raises(pingvox.Error, match="hit"):
        wall().insert_points([[1, 2, 3]], [0, 0, 0], hit=1.5)
    with pytest.raises(TypeError):
        pingvox.OccupancyMap(resolution=object())  # type: ignore[arg-type]
    limited = pingvox.OccupancyMap(resolution=0.001, memory_limit="1M")
    with pytest.raises(pingvox.Error) as raised:
        limited.insert_points(np.random.default_rng(1).uniform(-5, 5, (2000, 3)), [0, 0, 0])
    assert raised.value.code == "limit"


def test_single_precision_is_taken_as_it_is() -> None:
    points = np.random.default_rng(2).uniform(-3, 3, (500, 3)).astype(np.float32)
    single, double = pingvox.OccupancyMap(), pingvox.OccupancyMap()
    single.insert_points(points, [0, 0, 0])
    double.insert_points(points.astype(np.float64), [0, 0, 0])
    assert single.info() == {**double.info(), "memory_bytes": single.memory_bytes}


def test_a_million_look_ups_in_one_call() -> None:
    made = wall()
    points = np.random.default_rng(3).uniform(-3, 3, (1_000_000, 3))
    many = made.log_odds(points)
    some = np.arange(0, len(points), 9973)
    assert np.array_equal(many[some], np.array([made.log_odds(points[i])[0] for i in some]), equal_nan=True)


def test_threads_share_a_map() -> None:
    made = pingvox.OccupancyMap(resolution=0.1)
    clouds = [np.random.default_rng(seed).uniform(-2, 2, (2000, 3)) for seed in range(8)]
    errors: list[BaseException] = []

    def work(cloud: np.ndarray) -> None:  # type: ignore[type-arg]
        try:
            for _ in range(3):
                made.insert_points(cloud, [0, 0, 0])
                made.log_odds(cloud)
                len(made.leaves())
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=work, args=(cloud,)) for cloud in clouds]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors
    assert made.info()["occupied_cells"] > 0
