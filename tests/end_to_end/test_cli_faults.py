"""Whatever happens to a command: no traceback, no lost batch, an exit code that says what happened."""

import json
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NoReturn

import cv2
import numpy as np
import pytest
from PIL import Image
from tests import command
from tests.damage import damaged
from tests.studies import contact, finger, write_study

import fingerpad.image
from fingerpad import testing
from fingerpad.report import write_report
from fingerpad.simulate import render_contact_image
from fingerpad.study.pipeline import run_study

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "dzidek2017"
SEQUENCE = EXAMPLE / "synthetic" / "synthetic_press_30deg.tif"
HERTZ = ("hertz", "--radii-mm", "12", "14", "--load-n", "2", "--reduced-modulus-kpa", "100")
PROGRAM = (sys.executable, "-m", "fingerpad")


def shell(redirection: str, *arguments: str) -> tuple[int, str]:
    """Run the program in a shell that redirects its streams, and return exit code and stderr."""
    script = f'"$@" {redirection}'
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", script, "bash", *PROGRAM, *arguments],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        timeout=120,
    )
    return done.returncode, done.stderr


CLOSED = "fingerpad: cannot write: standard output is closed; redirect it to a file, or to /dev/null"
FULL = "fingerpad: cannot write (No space left on device)"


@pytest.mark.parametrize(
    ("redirection", "message", "arguments"),
    [
        (">&-", CLOSED, HERTZ),
        (">/dev/full", FULL, (*HERTZ, "--json")),
        (">&- 2>&-", "", HERTZ),
    ],
)
def test_unwritable_output(redirection: str, message: str, arguments: tuple[str, ...]) -> None:
    code, err = shell(redirection, *arguments)
    assert code == 1
    assert err.strip() == message


def test_closed_pipe_is_no_error() -> None:
    done = subprocess.Popen([*PROGRAM, *HERTZ], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert done.stdout is not None
    done.stdout.close()
    _, err = done.communicate(timeout=120)
    assert (done.returncode, err) == (1, b"")


def test_closed_stdin_and_stderr(tmp_path: Path) -> None:
    results, log = tmp_path / "out", tmp_path / "log"
    here = write_study(tmp_path, finger(), contact("o"), uncertainty={"wedge_angle_deg_std": 0.3})
    code, err = shell("<&- 2>&-", "run", str(here), "--out", str(results), "--log", str(log))
    assert (code, err) == (0, "")
    assert (results / "results.csv").is_file()
    assert all(json.loads(line) for line in log.read_text(encoding="utf-8").splitlines())


@pytest.fixture(scope="module")
def prints(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("prints")
    truth = render_contact_image(seed=1)
    files = [folder / f"{number}.png" for number in range(3)]
    for file in files:
        Image.fromarray(truth.pixels).save(file)
    return files


@pytest.mark.parametrize("fault", [MemoryError(), cv2.error("bad\nsize")])
def test_unexpected_error_fails_one_picture(
    fault: Exception, prints: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    read = fingerpad.image.read_image

    def read_all_but_one(path: Path, **options: bool):
        if path == prints[1]:
            raise fault
        return read(path, **options)

    monkeypatch.setattr(fingerpad.image, "read_image", read_all_but_one)
    code, out, err = command.run("measure", "print", *prints, "--ppi", 500, "--json")
    assert (code, err) == (3, "")
    good, bad, other = json.loads(out)
    assert good["semi_major_mm"] == other["semi_major_mm"] > 0
    assert bad["error"].startswith(f"{prints[1]}: cannot be measured (")
    assert "\n" not in bad["error"]
    code, out, err = command.run("measure", "print", *prints, "--ppi", 500)
    assert (code, err) == (3, "")
    assert out.count("semi_major_mm ") == 2
    assert "cannot be measured (" in out


def test_results_printed_before_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write = fingerpad.image.write_overlay

    def write_some(path: Path, *given: object, **named: object) -> None:
        if path.stem.endswith("12"):
            raise ZeroDivisionError("division by zero")
        write(path, *given, **named)

    monkeypatch.setattr(fingerpad.image, "write_overlay", write_some)
    overlay = tmp_path / "overlay"
    code, out, err = command.run(
        "measure", "sequence", SEQUENCE, "--ppi", 240, "--overlay-dir", overlay, "--json"
    )
    assert code == 1
    assert err == "fingerpad: this cannot be done (ZeroDivisionError: division by zero)\n"
    assert [frame["frame"] for frame in json.loads(out)] == list(range(12))


def interruptible(*arguments: object) -> subprocess.Popen[str]:
    """Start the program with interrupts, which processes started in the background ignore."""
    script = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "from fingerpad.__main__ import main; print('started', flush=True); main()"
    )
    command = [sys.executable, "-c", script, *map(str, arguments)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "started\n"
    return process


@pytest.mark.nightly
def test_interrupt_without_traceback(prints: list[Path]) -> None:
    rng = np.random.default_rng(2)
    commands = [("measure", "print", *prints * 20, "--ppi", 500), HERTZ]
    codes = []
    for number in range(16):
        process = interruptible(*commands[number % 2])
        time.sleep(rng.uniform(0.03, 1.2))
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
        assert err in {"", "fingerpad: interrupted\n"}
        codes.append(process.returncode)
    assert set(codes) <= {0, 130, -signal.SIGINT}
    assert codes.count(130) >= 3


DELETED = "class Deleted:\n    def __del__(self): raise KeyboardInterrupt\n"
REPRODUCE = "fingerpad.published.audit"


@pytest.mark.parametrize(
    ("place", "function"),
    [
        # An exception in a destructor is ignored, an interrupt that comes there too.
        ("fingerpad.__main__._run", f"{DELETED}def instead():\n    Deleted()\n    return real()\n"),
        # The same where a thread takes longer to start than to interrupt.
        (
            "fingerpad.__main__._run",
            "import time\nclass Slow(program.Timer):\n"
            "    def start(self): super().start(); time.sleep(0.03)\nprogram.Timer = Slow\n"
            f"{DELETED}def instead():\n    Deleted()\n    return real()\n",
        ),
        # A class that is being made turns one into a RuntimeError, before any command runs.
        (
            "fingerpad.__main__._open_streams",
            "def instead():\n    raise RuntimeError('__set_name__') from KeyboardInterrupt()\n",
        ),
        # While the words of arguments are read.
        (
            "fingerpad.__main__._run",
            "import typer.core\ndef interrupted(*_): raise KeyboardInterrupt\n"
            "typer.core.TyperGroup.parse_args = interrupted\ninstead = real\n",
        ),
        # A compiled module that is interrupted while it makes its classes crashes when Python closes it.
        (
            REPRODUCE,
            "import enum\nmake = enum.EnumType.__call__\n"
            "def interrupted(cls, *arguments, **named):\n"
            "    if len(arguments) == 1: return make(cls, *arguments)\n"
            "    enum.EnumType.__call__ = make\n    raise KeyboardInterrupt\n"
            "def instead():\n    enum.EnumType.__call__ = interrupted\n    import matplotlib.ft2font\n",
        ),
    ],
)
def test_wrapped_interrupt_is_interrupt(place: str, function: str) -> None:
    module, _, name = place.rpartition(".")
    script = (
        "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        f"sys.argv[1:] = ['reproduce']; import fingerpad.__main__ as program, {module} as module\n"
        f"real = module.{name}\n{function}module.{name} = instead\nprogram.main()"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "fingerpad: interrupted\n")


def test_interrupt_at_the_end_without_traceback() -> None:
    script = (
        "import sys, fingerpad.__main__ as program\n"
        "def interrupted(*_): raise KeyboardInterrupt\n"
        "sys.argv[1:] = ['--version']; program.signal.signal = interrupted; program.main()"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (-signal.SIGINT, "")


def test_interrupted_sequence_message() -> None:
    with interruptible("measure", "sequence", SEQUENCE, "--ppi", 240, "--json") as process:
        first = process.stdout.readline()
        process.send_signal(signal.SIGINT)
        rest, err = process.stdout.read(), process.stderr.read()
    assert (process.returncode, err) == (130, "fingerpad: interrupted\n")
    assert json.loads(first + rest)[0]["frame"] == 0


def test_endless_files_refused(tmp_path: Path) -> None:
    """In a process that can be ended, should one of them be read."""
    script = (
        "from fingerpad.cli import app\n"
        "from typer.testing import CliRunner\n"
        "for command in ['status'], ['fit'], 'import fiji --ppi 500 --std-mm 0.1'.split():\n"
        "    done = CliRunner().invoke(app, [*command, '/dev/zero'])\n"
        "    print(done.exit_code.real, done.stdout, done.stderr, end='')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=120, cwd=tmp_path
    )
    assert done.stdout == 3 * "2  fingerpad: /dev/zero: is a device, not a file\n"
    assert (done.returncode, done.stderr) == (0, "")


# Damaged manifests and tables through the commands that read them


PATIENCE_S = 120
RESULTS = " ,Label,Major,Minor,Angle\n1,a_30deg_2N.png,300,200,90\n2,b_45deg_1N.png,280,210,80\n"
ROWS = (
    "name,finger,wedge_angle_deg,load_N,semi_major_mm,semi_minor_mm,ellipse_mm_std\n"
    "second,synthetic_pad,45,1,5,4,0.1\nthird,synthetic_pad,45,2,6,5,0.1\n"
)
DAMAGED = (
    "demo/study.toml", "demo/observations.csv", "small/study.toml", "small/observations.csv", "Results.csv",
    "small/curve.csv", "whole/results.json", "whole/summary.json", "whole/results.csv",
)  # fmt: skip


class TooLate(BaseException):
    """A command took longer than it may."""


@pytest.fixture
def impatience() -> Iterator[None]:
    """Raise where an alarm goes off."""

    def too_late(*_: object) -> NoReturn:
        raise TooLate

    before = signal.signal(signal.SIGALRM, too_late)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


def is_accepted(seed: int, *arguments: object) -> bool:
    """Whether a command gives a result; one that does not refuses in words."""
    signal.alarm(PATIENCE_S)
    code, _, err = command.run(*arguments)
    assert "this cannot be done (" not in err, (seed, arguments, err)
    assert "Traceback" not in err, (seed, arguments, err)
    assert code in {0, 3} or err.strip(), (seed, arguments)
    return code in {0, 3}


@pytest.mark.usefixtures("impatience")
def test_commands_answer_or_refuse(tmp_path: Path) -> None:
    demo, small, whole, out, none = (tmp_path / name for name in ("demo", "small", "whole", "out", "none"))
    shutil.copytree(EXAMPLE, demo)
    manifest = testing.write_study(small, loads=(1.0,)).path
    manifest.write_text(f'observations_csv = "observations.csv"\n{manifest.read_text()}')
    (small / "observations.csv").write_text(ROWS)
    (tmp_path / "Results.csv").write_text(RESULTS)
    run_study(small, whole, write_report=write_report)
    originals, outcomes = {path: path.read_bytes() for path in map(tmp_path.joinpath, DAMAGED)}, set()
    fiji = ("import", "fiji", tmp_path / "Results.csv", "--std-mm", 0.1, "--ppi", 500, "--out")
    for seed in range(15):
        rng = random.Random(seed)
        for path, content in originals.items():
            path.write_bytes(content if rng.random() < 0.6 else damaged(content, rng))
        accepted = [
            is_accepted(seed, "status", demo, "--out", none),
            is_accepted(seed, "verify", small, "--out", whole),
            is_accepted(seed, "compare", whole),
            is_accepted(seed, *fiji, tmp_path / f"imported_{seed}.csv"),
            is_accepted(seed, "status", small, "--out", none),
        ]
        outcomes |= {*accepted}
        if accepted[-1] and not out.exists():
            is_accepted(seed, "run", small, "--out", out)
        if not seed:
            is_accepted(seed, "fit", small / "curve.csv")
    assert out.exists()
    assert outcomes == {False, True}
