"""Builds the package `pingvox` for pip: CMake does the work."""

import os
import re
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parent


def version() -> str:
    found = re.search(r"^  VERSION ([0-9.]+)$", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)
    assert found
    return found[1]


class BuildByCMake(build_ext):
    """Builds and installs the target _pingvox.

    PINGVOX_PYTHON_BUILD names the folder of the build, build/python by default; PINGVOX_PYTHON_PRESET the preset.
    """

    def run(self) -> None:
        build = Path(os.environ.get("PINGVOX_PYTHON_BUILD", ROOT / "build" / "python"))
        to = Path(self.get_ext_fullpath("pingvox._pingvox")).resolve().parent.parent
        jobs = str(self.parallel or len(os.sched_getaffinity(0)))
        configure = ["cmake", "--preset", os.environ.get("PINGVOX_PYTHON_PRESET", "release"), "-B", str(build)]
        options = {
            "PINGVOX_BUILD_PYTHON": "ON",
            "PINGVOX_BUILD_APP": "OFF",
            "PINGVOX_PYTHON_INSTALL_DIR": ".",
            "Python_EXECUTABLE": sys.executable,
        }
        subprocess.run(configure + [f"-D{name}={value}" for name, value in options.items()], cwd=ROOT, check=True)
        subprocess.run(["cmake", "--build", str(build), "-j", jobs, "--target", "_pingvox"], cwd=ROOT, check=True)
        subprocess.run(
            ["cmake", "--install", str(build), "--component", "python", "--strip", "--prefix", str(to)],
            cwd=ROOT,
            check=True,
        )


setup(
    version=version(),
    packages=[],
    ext_modules=[Extension("pingvox._pingvox", sources=[])],
    cmdclass={"build_ext": BuildByCMake},
)
