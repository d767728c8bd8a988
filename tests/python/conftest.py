"""Recordings that the program simulates, and what it makes of them: what the module is compared with."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest

PROGRAM = os.environ["PINGVOX_PROGRAM"]


class Program:
    """The program `pingvox`, called in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __call__(self, *args: object) -> str:
        done = subprocess.run([PROGRAM, *map(str, args)], cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def json(self, *args: object) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(self(*args, "--json"))
        return found

    def warnings(self, *args: object) -> list[str]:
        done = subprocess.run([PROGRAM, *map(str, args)], cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return [line.removeprefix("pingvox: ") for line in done.stderr.splitlines()]

    def error(self, *args: object) -> str:
        done = subprocess.run([PROGRAM, *map(str, args)], cwd=self.folder, capture_output=True, text=True, check=False)
        assert done.returncode != 0
        return done.stderr.strip().removeprefix("pingvox: ")


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Program:
    return Program(tmp_path_factory.mktemp("dive"))


@pytest.fixture(scope="session")
def tank(program: Program) -> Path:
    """A head that stands still in a tank: 1000 beams, five turns."""
    program("simulate", "tank", "-o", "tank.csv", "--seed", 1, "--quiet")
    return program.folder / "tank.csv"


@pytest.fixture(scope="session")
def dive(program: Program) -> tuple[Path, Path]:
    """A vehicle in a harbour: its sonar, and its navigation."""
    program("simulate", "harbour", "-o", "dive.csv", "--nav", "nav.csv", "--trajectory", "loop", "--turns", 6, "--quiet")
    return program.folder / "dive.csv", program.folder / "nav.csv"
