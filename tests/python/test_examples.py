"""The examples run as they are."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import Program

EXAMPLES = Path(os.environ["PINGVOX_SOURCE_DIR"]) / "examples" / "python"


def run(name: str, *args: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(EXAMPLES / name), *map(str, args)], capture_output=True, text=True, check=False
    )


def test_map_with_matplotlib(program: Program, tank: Path) -> None:
    pytest.importorskip("matplotlib")
    done = run("map_with_matplotlib.py", tank, program.folder / "picture.png")
    assert done.returncode == 0, done.stderr
    assert "1000 beams" in done.stdout
    assert (program.folder / "picture.png").stat().st_size > 10_000


def test_slam(program: Program, dive: tuple[Path, Path]) -> None:
    done = run("slam.py", *dive, program.folder / "example.bt")
    assert done.returncode == 0, done.stderr
    assert "nearest wall" in done.stdout
    assert (program.folder / "example.bt").exists()


def test_map_to_rerun_says_what_is_missing(tank: Path) -> None:
    try:
        import rerun  # noqa: F401
    except ImportError:
        done = run("map_to_rerun.py", tank)
        assert done.returncode == 1
        assert "rerun is not installed" in done.stderr
    else:
        pytest.skip("would open rerun's viewer")
