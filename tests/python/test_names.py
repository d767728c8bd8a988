"""Keywords, options, stubs and docstrings agree with each other."""

import ast
import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pingvox
import pytest
from conftest import Program

STUB = Path(pingvox.__file__).parent / "_pingvox.pyi"
FUNCTIONS = {
    "open": "open",
    "filter_image": "filter_image",
    "Recording.map": "Recording.map",
    "Recording.slam": "Recording.slam",
    "Recording.locate": "Recording.locate",
    "Recording.evaluate": "Recording.evaluate",
    "SlamResult.map": "SlamResult.map",
    "OccupancyMap": "OccupancyMap.__init__",
    "OccupancyMap.open": "OccupancyMap.open",
    "OccupancyMap.insert_points": "OccupancyMap.insert_points",
    "BeamMapper": "BeamMapper.__init__",
    "Beams.echoes": "Beams.echoes",
    "LiveMapping": "LiveMapping.__init__",
    "LiveMapping.drive": "LiveMapping.drive",
}
# Options that are no keywords: files that the program writes, and how it talks.
OF_THE_PROGRAM = {"config", "format", "help", "json", "output", "progress", "quiet"}
FILES = {"calibration", "covariance", "graph", "map"}


def keywords_in_stub() -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}

    def look(nodes: list[ast.stmt], prefix: str) -> None:
        for node in nodes:
            if isinstance(node, ast.ClassDef):
                look(node.body, f"{node.name}.")
            elif isinstance(node, ast.FunctionDef):
                found[prefix + node.name] = {arg.arg for arg in node.args.kwonlyargs}

    look(ast.parse(STUB.read_text()).body, "")
    return found


@pytest.mark.parametrize("function", FUNCTIONS)
def test_stub_has_the_keywords(function: str) -> None:
    assert keywords_in_stub()[FUNCTIONS[function]] - {"progress"} == set(pingvox.options_of(function))


@pytest.mark.parametrize(
    ("command", "functions", "others"),
    [
        ("map", ["open", "Recording.map"], set()),
        ("slam", ["open", "Recording.slam", "SlamResult.map"], FILES),
        # Of odometry open() takes poses; which poses are known is told by `known`.
        ("locate", ["open", "Recording.locate"], {"map", "odometry", "only_sure"}),
        ("evaluate", ["open", "Recording.evaluate"], {"fit"}),
        # What Python writes and shows by itself.
        ("live", ["LiveMapping"], {"write_every", "beams", "poses_out", "view", "blueos"}),
    ],
)
def test_each_option_of_the_program_is_a_keyword(
    program: Program, command: str, functions: list[str], others: set[str]
) -> None:
    options = set(re.findall(r"^  (?:-\w, |    )--([a-z-]+)", program(command, "--help"), re.MULTILINE))
    assert len(options) > 10
    keywords = set().union(*(pingvox.options_of(function) for function in functions))
    assert {name.replace("-", "_") for name in options} - OF_THE_PROGRAM - others <= keywords


def test_each_keyword_is_an_option_of_the_program(program: Program) -> None:
    helps = "".join(program(command, "--help") for command in ("map", "slam", "locate", "evaluate", "live"))
    for function in FUNCTIONS:
        for keyword, text in pingvox.options_of(function).items():
            assert f"--{keyword.replace('_', '-')}" in helps
            assert len(text) > 10


@pytest.mark.parametrize("function", ["Nope", "", "map", "OccupancyMap.save", "Recording.maps"])
def test_options_of_unknown_functions_are_an_error(function: str) -> None:
    with pytest.raises(pingvox.Error, match=f"function: must be open, .*LiveMapping.drive, not '{function}'") as raised:
        pingvox.options_of(function)
    if function == "Recording.maps":
        assert str(raised.value).endswith("did you mean 'Recording.map'?")


def test_all_names_have_docstrings() -> None:
    for name in pingvox.__all__:
        thing = getattr(pingvox, name)
        if not isinstance(thing, type):
            continue
        assert thing.__doc__, name
        for attribute, value in vars(thing).items():
            if not attribute.startswith("_") and thing.__module__.endswith("_pingvox"):
                assert getattr(value, "__doc__", None), f"{name}.{attribute}"


def test_all_names_are_in_the_stub() -> None:
    classes = {node.name: node for node in ast.parse(STUB.read_text()).body if isinstance(node, ast.ClassDef)}
    for name in dir(pingvox._pingvox):
        thing = getattr(pingvox._pingvox, name)
        if name.startswith("_") or not isinstance(thing, type):
            continue
        told = {node.name for node in classes[name].body if isinstance(node, ast.FunctionDef)}
        there = {attribute for attribute in vars(thing) if not attribute.startswith("_")}
        assert there == {attribute for attribute in told if not attribute.startswith("_")}, name


@pytest.fixture(scope="module")
def mypy() -> str:
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("mypy is not installed")
    return str(Path(pingvox.__file__).parent)


def test_mypy_takes_the_package(mypy: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", os.devnull, mypy],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout


def test_stubs_fit_the_module(mypy: str, tmp_path: Path) -> None:
    allowed = tmp_path / "allowed"
    # Classes of pybind11 have a metaclass of their own, and an __init__ that takes anything.
    allowed.write_text("pingvox\\.((_pingvox|live_event)\\.)?\\w+\npingvox\\.((_pingvox|live_event)\\.)?\\w+\\.__init__\n")
    done = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "--concise", "--ignore-unused-allowlist", "--allowlist", str(allowed), "pingvox"],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
        env={**os.environ, "MYPYPATH": str(Path(mypy).parent)},
    )
    assert done.returncode == 0, done.stdout + done.stderr
