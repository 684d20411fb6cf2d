"""Every flag that takes numbers, given absurd ones: a refusal that names it, or a result.

A new command with such a flag needs an example in `VALID`, and a new flag that is nothing alone an entry in
`BESIDE`.
"""

import inspect
import typing
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import typer
from PIL import Image
from tests.studies import contact, finger, write_numbers, write_study
from typer.testing import CliRunner

from fingerpad.cli import app
from fingerpad.figures import new_panels, plot_uncertainty_budget
from fingerpad.simulate import render_coin, render_contact_image, render_finger, simulate_loading_curve

ABSURD = ("nan", "inf", "-1", "0", "1e300", "1e-300")
NO_NUMBER = ("", "½")  # which Click refuses where it reads the number
# Flags of numbers that are given as text.
OF_TEXT = {"--roi-px", "--seed-px", "--scale-line", "--scale-circle", "--grid-points"}
# Possible numbers that what is measured contradicts, in words of its own.
IN_PLAIN_WORDS = {
    "--load-range-n", "--seed-px", "--contact-load-n", "--port", "--cycle", "--threshold",
    "--loading-radius-mm",
}  # fmt: skip
# One example of each command, which runs in the folder of the fixture.
VALID = {
    "init": "fresh",
    "geometry": "--semi-axes-mm 8 14 12 --wedge-deg 30",
    "hertz": "--radii-mm 12 14 --reduced-modulus-kpa 100 --load-n 2",
    "modulus": "--semi-axes-mm 8 14 12 --wedge-deg 30 --load-n 2 --area-mm2 90",
    "solve": "--semi-axes-mm 8 14 12 --wedge-deg 30 --youngs-modulus-kpa 100 --load-n 2 --grid 64",
    "fields": "--semi-axes-mm 8 14 12 --wedge-deg 9 --youngs-modulus-kpa 9 --load-n 1 --depth-mm 1 --grid 64",
    "simulator": "--semi-axes-mm 8 14 12 --wedge-deg 30 --youngs-modulus-kpa 100 --load-n 1 2",
    "correct": "--ellipse-mm 7 5 --radius-mm 18",
    "fit": "curve.csv --stage-compliance-mm-per-n 0",
    "figure": "figure.json",
    "run": "study.toml",
    "app": "nowhere.toml",  # which does not begin to serve
    "measure print": "print.png --ppi 250",
    "measure photo": "palmar.png --face palmar --mm-per-px 0.2",
    "measure sequence": "frames --ppi 250 --frames-per-second 10",
    "import fiji": "Results.csv --std-mm 0.1 --ppi 500",
}
# What a flag needs beside it, and what it stands in place of.
BESIDE = {
    "modulus --area-mm2": ("", "--area-mm2"),
    "modulus --indentation-mm": ("", "--area-mm2"),
    "--indentation-mm": ("", "--load-n"),
    "--area-mm2": ("", "--load-n"),
    "--loading-radius-mm-std": ("--loading-radius-mm 12", ""),
    "--stage-compliance-mm-per-n-std": ("--stage-compliance-mm-per-n 0.01", ""),
    "--area-delay-s-std": ("--area-delay-s 0.02", ""),
    "--constraint-std": ("--constraint 2", ""),
    "--scale-line": ("--line-mm 10", "--ppi --mm-per-px"),
    "--line-mm": ("--scale-line 5,5,5,200", "--ppi --mm-per-px"),
    "--line-mm-std": ("--scale-line 5,5,5,200 --line-mm 10", "--ppi --mm-per-px"),
    "--line-px-std": ("--scale-line 5,5,5,200 --line-mm 10", "--ppi --mm-per-px"),
    "--coin-mm": ("--coin coin.png", "--ppi --mm-per-px"),
    "--coin-mm-std": ("--coin coin.png --coin-mm 23", "--ppi --mm-per-px"),
    "--scale-circle": ("--circle-mm 10", "--ppi --mm-per-px"),
    "--circle-mm": ("--scale-circle 5,5,5,200,90,90", "--ppi --mm-per-px"),
    "--circle-mm-std": ("--scale-circle 5,5,5,200,90,90 --circle-mm 10", "--ppi --mm-per-px"),
    "--circle-px-std": ("--scale-circle 5,5,5,200,90,90 --circle-mm 10", "--ppi --mm-per-px"),
    "--grid-points": ("--grid grid.png --grid-spacing-mm 1", "--ppi --mm-per-px"),
    "--grid-spacing-mm": ("--grid grid.png --grid-points 7,9", "--ppi --mm-per-px"),
    "--grid-spacing-mm-std": ("--grid grid.png --grid-points 7,9 --grid-spacing-mm 1", "--ppi --mm-per-px"),
    "--mm-per-px": ("", "--ppi"),
    "--ppi": ("", "--mm-per-px"),
    "--start-s": ("--force force.csv", ""),
    "--contact-load-n": ("--force force.csv", ""),
}


def commands() -> dict[str, Callable[..., None]]:
    """Return the commands by the words that call them."""
    groups = [("", app), *((f"{group.name} ", group.typer_instance) for group in app.registered_groups)]
    return {
        prefix + (command.name or command.callback.__name__): command.callback
        for prefix, group in groups
        for command in group.registered_commands
    }


def flags() -> Iterator[tuple[str, str, int]]:
    """Yield each command with each of its flags that take numbers, and how many it takes."""
    for name, callback in commands().items():
        for parameter in inspect.signature(callback).parameters.values():
            kind, option = typing.get_args(parameter.annotation)[:2]
            if not isinstance(option, typer.models.OptionInfo):
                continue
            names = [text for text in option.param_decls or () if text.startswith("--")]
            flag = names[0] if names else f"--{parameter.name.replace('_', '-')}"
            kinds = {kind, *typing.get_args(kind)}
            if flag in OF_TEXT or kinds & {int, float}:
                yield name, flag, len(typing.get_args(kind)) if typing.get_origin(kind) is tuple else 1


def small_print(seed: int) -> np.ndarray:
    return render_contact_image(semi_major=4.0, semi_minor=3.0, ppi=250, seed=seed).pixels


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("flags")
    Image.fromarray(small_print(1)).save(folder / "print.png")
    (folder / "frames").mkdir()
    for number in range(4):
        Image.fromarray(small_print(number)).save(folder / "frames" / f"{number}.png")
    Image.fromarray(render_finger("palmar", mm_per_px=0.2, seed=1).pixels).save(folder / "palmar.png")
    Image.fromarray(render_coin(radius=60.0).pixels).save(folder / "coin.png")
    board = np.full((200, 240), 230, dtype=np.uint8)
    board[20:180, 20:220][np.kron(np.indices((8, 10)).sum(axis=0) % 2 == 0, np.ones((20, 20), bool))] = 30
    Image.fromarray(board).save(folder / "grid.png")
    write_study(folder, finger(), contact(axis=""), uncertainty={"wedge_angle_deg_std": 0.3})
    (folder / "force.csv").write_text("time_s,force_N\n" + "".join(f"{t / 10},{t}\n" for t in range(9)))
    (folder / "Results.csv").write_text(" ,Major,Minor,Angle\n1,300,200,90\n", encoding="utf-8")
    drawn, (panel,) = new_panels()
    plot_uncertainty_budget(panel, {"load": 0.1, "scale": 0.9})
    (folder / "figure.json").write_text(drawn.to_json(), encoding="utf-8")
    curve = simulate_loading_curve()
    assert curve.time is not None
    rows = np.column_stack((curve.time, curve.load, curve.indentation))[::40]
    write_numbers(folder / "curve.csv", "time_s,force_N,displacement_mm", rows)
    return folder


def example(command: str) -> list[str]:
    if command not in VALID:
        pytest.fail(f"VALID: add an example of the new command here: {command!r}")
    return VALID[command].split()


def called(command: str, given: list[str], out: Path) -> Any:
    """Call a command, which writes to `out` if it writes anything."""
    writes = "out" in inspect.signature(commands()[command]).parameters
    return CliRunner().invoke(app, [*command.split(), *given, *(["--out", str(out)] if writes else [])])


@pytest.mark.parametrize("command", sorted({command for command, *_ in flags()} - {"app"}))
def test_examples_run(command: str, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    done = called(command, example(command), tmp_path / "out.svg")
    assert (done.exit_code, done.exception) == (0, None), done.stderr


def arguments(command: str, flag: str, count: int, value: str) -> list[str]:
    beside, without = BESIDE.get(f"{command} {flag}") or BESIDE.get(flag, ("", ""))
    base, given = [*example(command), *beside.split()], []
    dropped = {flag, *without.split()}
    while base:
        word = base.pop(0)
        if word not in dropped:
            given.append(word)
            continue
        while base and not base[0].startswith("--"):
            base.pop(0)
    return [*given, flag, *[value] * count]


@pytest.mark.parametrize(("command", "flag", "count"), list(flags()))
def test_extreme_numbers(
    command: str, flag: str, count: int, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    faults = []
    read_by_us = flag in OF_TEXT or count > 1
    for number, value in enumerate(ABSURD + NO_NUMBER * read_by_us):
        done = called(command, arguments(command, flag, count, value), tmp_path / f"{number}.svg")
        words = " ".join(done.stderr.replace("│", " ").split())
        unforeseen = "cannot be done (" in words or "cannot be measured (" in done.stdout
        named = flag in words or flag in IN_PLAIN_WORDS
        if unforeseen or done.exit_code not in {0, 2, 3} or (done.exit_code == 2 and not named):
            faults.append((value, done.exit_code, words or done.stdout[-300:]))
    assert not faults
