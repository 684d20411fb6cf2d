"""Kills, flipped bits and full disks.

Each part prints what it did and what was lost, mixed or unnamed; the sums must be zero.
"""

import json
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final
from urllib.parse import quote

import numpy as np
from PIL import Image

from fingerpad.exceptions import FingerpadError, StoreError
from fingerpad.report import write_report
from fingerpad.simulate import render_contact_image
from fingerpad.study.corrections.log import CorrectionLog
from fingerpad.study.engine.store import STORE_NAME
from fingerpad.study.manifest import read_study
from fingerpad.study.pipeline import run_study
from fingerpad.study.results.result_set import result_set_faults
from fingerpad.study.results.table import records
from fingerpad.study.status import verify_study

PICTURES, FRAMES = 4, 60
_IN_BETWEEN: Final = "put its results in place"
_STUDY: Final = """title = "Synthetic"
[[fingers]]
name = "f"
semi_axes_mm = { palmar = 7.9, distal = 13.8, radial_ulnar = 11.8 }
semi_axes_mm_std = { palmar = 0.1, distal = 0.1, radial_ulnar = 0.1 }
synthetic = true
"""
_PICTURE: Final = """[[observations]]
name = "o{number}"
finger = "f"
wedge_angle_deg = 30
load_N = {load}
file = "o{number}.png"
scale = {{ ppi = 240 }}
synthetic = true
"""
_SEQUENCE: Final = """[[sequences]]
name = "p"
finger = "f"
wedge_angle_deg = 30
file = "frames"
scale = { ppi = 240 }
force = "force.csv"
frames_per_second = 20
synthetic = true
"""


def make_study(folder: Path) -> Path:
    """Write a study of contact images and a sequence, and return its manifest."""
    folder.mkdir()
    sizes = [4.0 + 0.1 * number for number in range(PICTURES)]
    for number, size in enumerate(sizes):
        truth = render_contact_image(semi_major=size, semi_minor=3.2, ppi=240, seed=number)
        Image.fromarray(truth.pixels).save(folder / f"o{number}.png")
    (folder / "frames").mkdir()
    loads = np.interp(np.arange(FRAMES), [0, FRAMES // 2, FRAMES - 1], [0.2, 2.0, 0.2])
    for number, load in enumerate(loads):
        truth = render_contact_image(
            semi_major=4.0 * load**0.3, semi_minor=3.2 * load**0.3, ppi=240, seed=number % 5
        )
        page = np.full((260, 220), 230, np.uint8)
        rows, columns = (min(a, b) for a, b in zip(page.shape, truth.pixels.shape, strict=True))
        page[:rows, :columns] = truth.pixels[:rows, :columns]
        Image.fromarray(page).save(folder / "frames" / f"f{number:03d}.png")
    rows_text = "\n".join(f"{number / 20},{load:.4f}" for number, load in enumerate(loads))
    (folder / "force.csv").write_text(f"time_s,force_N\n{rows_text}\n", encoding="ascii")
    pictures = "".join(_PICTURE.format(number=number, load=1 + number) for number in range(PICTURES))
    (folder / "study.toml").write_text(_STUDY + pictures + _SEQUENCE, encoding="utf-8")
    return folder / "study.toml"


def kill_runs(count: int = 100, seed: int = 1) -> Counter[str]:
    """Kill runs at random moments, on one process and on two, and compare what is left with whole runs."""
    rng, found = np.random.default_rng(seed), Counter[str]()
    with TemporaryDirectory() as folder:
        manifest, out = make_study(Path(folder) / "study"), Path(folder) / "out"
        whole = list(records(run_study(manifest, Path(folder) / "whole", write_report=write_report).rows))
        command = [sys.executable, "-m", "fingerpad", "run", str(manifest), "--out", str(out), "--workers"]
        began = time.perf_counter()
        subprocess.run([*command, "1"], check=True, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        longest = time.perf_counter() - began
        while found["kills"] < count:
            if rng.random() < 0.2:
                shutil.rmtree(out, ignore_errors=True)
            with subprocess.Popen(
                [*command, str(1 + found["kills"] % 2)], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL
            ) as process:
                with suppress(subprocess.TimeoutExpired):
                    process.wait(float(rng.uniform(0, longest)))
                if process.poll() is None:
                    process.kill()
                    found["kills"] += 1
            faults = result_set_faults(out) if out.exists() else []
            found["between"] += any(_IN_BETWEEN in fault for fault in faults)
            found["unnamed or mixed"] += any(_IN_BETWEEN not in fault for fault in faults)
            if rng.random() < 0.2:
                found["rows that differ"] += list(records(run_study(manifest, out).rows)) != whole
                found["faults afterwards"] += bool(verify_study(manifest, out).faults)
    return found


_API = "/api/studies/study"  # of the study in the folder of that name


class _Server:
    """The page of a study in a process of its own, asked over one connection."""

    def __init__(self, study: Path) -> None:
        command = [sys.executable, "-m", "fingerpad", "app", str(study), "--no-browser"]
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=study.parent
        )
        assert self.process.stdout is not None
        match = re.search(r"http://([^/]+)/start\?token=(\S+)", self.process.stdout.readline())
        assert match is not None
        self._connection = HTTPConnection(match[1], timeout=120)
        self._headers = {"authorization": f"Bearer {match[2]}"}

    def ask(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
        """Return the status and the answer."""
        raw = body if isinstance(body, bytes) or body is None else json.dumps(body).encode()
        kind = "application/octet-stream" if isinstance(body, bytes) else "application/json"
        self._connection.request(method, path, raw, {**self._headers, "content-type": kind})
        answer = self._connection.getresponse()
        return answer.status, json.loads(answer.read())

    def end(self) -> None:
        """Kill it, whatever it is doing."""
        self.process.kill()
        self.process.wait()
        self._connection.close()


def kill_server(count: int = 100, seed: int = 2) -> Counter[str]:
    """Kill the page's server in a stream of edits and uploads; what it confirmed must be there."""
    rng, found = np.random.default_rng(seed), Counter[str]()
    with TemporaryDirectory() as folder:
        study = make_study(Path(folder) / "study").parent
        confirmed: dict[str, Any] = {}
        number = 0
        for _ in range(count):
            server = _Server(study)
            deadline = time.monotonic() + float(rng.uniform(0.1, 1.5))
            try:
                found["lost"] += _lost(server, study, confirmed)
                while time.monotonic() < deadline:
                    number += 1
                    found["confirmed"] += _change(server, number, confirmed)
            except (OSError, HTTPException):
                found["server faults"] += 1
            finally:
                server.end()
                found["kills"] += 1
        found["faults afterwards"] = len(verify_study(study / "study.toml", study / "results").faults)
    return found


def _change(server: _Server, number: int, confirmed: dict[str, Any]) -> bool:
    """Edit the manifest, correct a picture or upload a file, and note what was confirmed."""
    kind = ("load", "correction", "upload")[number % 3]
    if kind == "load":
        _, state = server.ask("GET", f"{_API}/state")
        edit = {"kind": "observation", "key": "o0", "set": {"load_N": float(number)}}
        body = {"expected": state["digest"], "edits": [edit]}
        status, _ = server.ask("POST", f"{_API}/edits", body)
        value: Any = float(number)
    elif kind == "correction":
        _, known = server.ask("GET", f"{_API}/corrections?item=o1")
        change = {"threshold": float(number)}
        body = {"item": "o1", "expected": known["last_id"], "who": "soak", "change": change}
        status, _ = server.ask("POST", f"{_API}/corrections", body)
        value = change
    else:
        value = b"x_mm,y_mm\n" + b"1,2\n" * number
        name = quote(f"table_{number}.csv")
        status, record = server.ask("POST", f"{_API}/files?name={name}", value)
        if status < 300:
            confirmed.setdefault("files", {})[record["file"]] = value
            return True
    if status < 300:
        confirmed[kind] = value
    return status < 300


def _lost(server: _Server, study: Path, confirmed: dict[str, Any]) -> int:
    """Return how much of what was confirmed is not there; the newest unconfirmed change may be."""
    _, state = server.ask("GET", f"{_API}/state")
    load = next(one["load_N"] for one in state["observations"] if one["item"] == "o0")
    _, known = server.ask("GET", f"{_API}/corrections?item=o1")
    said = [one["change"] for one in known["history"]]
    files = confirmed.get("files", {})
    return sum(
        (
            "load" in confirmed and load < confirmed["load"],
            "correction" in confirmed and confirmed["correction"] not in said,
            *((study / name).read_bytes() != content for name, content in files.items()),
        )
    )


def flip_bits(count: int = 2000, seed: int = 3) -> Counter[str]:
    """Flip a bit of a stored file, and look whether reading it notices."""
    rng, found = np.random.default_rng(seed), Counter[str]()
    with TemporaryDirectory() as folder:
        manifest = make_study(Path(folder) / "study")
        study, out = manifest.parent, manifest.parent / "results"
        log = CorrectionLog(study)
        for item in ("o1", "p#7"):
            log.append(item, {"accepted": True}, who="soak", expected=0, study=read_study(manifest))
        rows = list(records(run_study(manifest, out, write_report=write_report).rows))
        kinds = {
            "results": ["results.csv", "results.json", "results_columns.csv", "summary.json", "SHA256SUMS"],
            "report": ["report.html", *_names(out, "figures/*.svg")],
            "overlays": _names(out, "overlays/**/*.png"),
            "store": [STORE_NAME],
            "corrections": ["../corrections.jsonl"],
        }
        for number in range(count):
            kind = list(kinds)[number % len(kinds)]
            path = out / str(rng.choice(kinds[kind]))
            before = path.read_bytes()
            flipped = bytearray(before)
            place = int(rng.integers(8 * len(before)))
            flipped[place // 8] ^= 1 << place % 8
            path.write_bytes(flipped)
            noticed = bool(verify_study(manifest, out).faults)
            found[f"{kind}: {'noticed' if noticed else 'no trace'}"] += 1
            if not noticed:  # then it must change nothing, as in the unused space of the store
                found["silent changes"] += not _same_rows(manifest, out, rows)
            path.write_bytes(before)
            for log_file in out.glob(f"{STORE_NAME}-*"):
                log_file.unlink()
    return found


def _names(out: Path, pattern: str) -> list[str]:
    return [path.relative_to(out).as_posix() for path in out.glob(pattern)]


def _same_rows(manifest: Path, out: Path, rows: list[Any]) -> bool:
    with TemporaryDirectory() as folder:
        copy = Path(shutil.copytree(out, Path(folder) / "out"))
        try:
            return list(records(run_study(manifest, copy).rows)) == rows
        except StoreError:
            return True


@contextmanager
def _small_disk(folder: Path, size: int) -> Iterator[Callable[[int], None]]:
    """Mount a small file system, and yield what changes its size."""

    def mount(*options: str) -> None:
        command = ["mount", "-t", "tmpfs", "-o", ",".join(options), "tmpfs", str(folder)]
        subprocess.run(command, check=True, capture_output=True)

    mount(f"size={size}")
    try:
        yield lambda more: mount("remount", f"size={more}")
    finally:
        subprocess.run(["umount", "-l", str(folder)], check=True)


def fill_disk(count: int = 40) -> Counter[str]:
    """Run on disks of growing size, each too small, and go on once there is room."""
    found = Counter[str]()
    with TemporaryDirectory() as folder:
        manifest = make_study(Path(folder) / "study")
        whole = Path(folder) / "whole"
        rows = list(records(run_study(manifest, whole, write_report=write_report).rows))
        needed = 2 * sum(path.stat().st_size for path in whole.rglob("*") if path.is_file())
        disk = Path(folder) / "disk"
        disk.mkdir()
        for size in np.linspace(4096, needed, count, dtype=int).tolist():
            try:
                with _small_disk(disk, size) as resize:
                    found["disks"] += 1
                    try:
                        run_study(manifest, disk / "out", write_report=write_report)
                        found["large enough"] += 1
                    except FingerpadError as error:
                        found["refused in words"] += 1
                        found["without a way out"] += "room" not in str(error)
                    faults = result_set_faults(disk / "out") if (disk / "out").exists() else []
                    found["mixed"] += any(_IN_BETWEEN not in fault for fault in faults)
                    resize(4 * needed)
                    same = (
                        list(records(run_study(manifest, disk / "out", write_report=write_report).rows))
                        == rows
                    )
                    found["rows that differ"] += not same
            except subprocess.CalledProcessError:
                found["not mounted: needs rights"] += 1
                break
    return found


def report(kills: int = 100, flips: int = 2000, disks: int = 40) -> None:
    """Print what was done and what was found."""
    print("\nKills, flipped bits and full disks")
    for name, found in (
        ("runs killed", kill_runs(kills)),
        ("servers killed", kill_server(kills)),
        ("bits flipped", flip_bits(flips)),
        ("disks filled", fill_disk(disks)),
    ):
        print(f"  {name}: " + ", ".join(f"{what} {count}" for what, count in sorted(found.items())))
