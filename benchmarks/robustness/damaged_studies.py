"""Study folders damaged at random and asked through the page.

Keys, values and types of the manifest, its spreadsheet, corrections and results are changed, and so are their
bytes. Every GET route must answer what it can in time, and say in words what it cannot.
"""

import asyncio
import csv
import io
import json
import random
import tomllib
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Final

import httpx
import tomlkit

from fingerpad.exceptions import FingerpadError
from fingerpad.study.corrections.log import CORRECTIONS_NAME, CorrectionLog
from fingerpad.study.manifest.load import read_study
from fingerpad.web.app import make_api, make_app
from fingerpad.web.security import Access
from fingerpad.web.workspace import Workspace

TOKEN: Final = "benchmark"
DEMO: Final = Path(__file__).parents[2] / "examples" / "dzidek2017"
PATIENCE_S: Final = 20.0
# Values that are right somewhere and wrong elsewhere; JSON and TOML take most of them.
ODD: Final[tuple[Any, ...]] = (
    0, -1, 1, 2**63 - 1, 1e308, -0.0, float("nan"), float("inf"), True, False, "", "x", "\x00", "../a.png",
    "ü☃", "/dev/zero", ".", "=1+1", "a/b", "#", "left_index_ellipse", "a" * 300,
    [], [[]], [1, 2], [None], {}, {"name": 3},
    {"ppi": 500}, ["a", "a"], None,
)  # fmt: skip
NAME: Final = "demo"
EVENTS: Final = f"/api/studies/{NAME}/events"
STUDY: Final = "/api/studies/{study}"
PHOTOGRAPH: Final = "synthetic_pad/synthetic/photograph_palmar.jpg"
ITEMS: Final = "waiting", "synthetic_30deg_2N", PHOTOGRAPH, "synthetic_press_30deg#3"
# What to ask of routes that need to be asked something.
QUERIES: Final[dict[str, tuple[dict[str, Any], ...]]] = {
    f"{STUDY}/frames": ({"sequence": "synthetic_press_30deg"},),
    **{
        f"{STUDY}/picture/{kind}": tuple({"item": item, **more} for item in ITEMS)
        for kind, more in (("info", {}), ("preview", {"longest_px": 64}), ("thumbnail", {}))
    },
    f"{STUDY}/corrections": ({"item": "synthetic_30deg_2N"}, {"item": "synthetic_press_30deg#3"}),
    f"{STUDY}/results/rows": ({}, {"sort": "load_N", "status": "measured"}, {"sort": "-reason", "text": "a"}),
    f"{STUDY}/results/plot": ({},),
    f"{STUDY}/download/{{path}}": ({"path": "results.csv"}, {"path": "study.zip"}, {"path": "figures/x.svg"}),
}
# They cost much, whatever the study says: asked of some studies only.
SLOW: Final = frozenset(("/api/published", f"/api/studies/{NAME}/download/study.zip"))


def add_corrections(folder: Path) -> None:
    """Add corrections and incomplete tables to the demo study."""
    manifest = folder / "study.toml"
    log, study = CorrectionLog(folder), read_study(manifest)
    for item, change in (
        ("synthetic_30deg_2N", {"threshold": 50.0}),
        ("synthetic_press_30deg#3", {"rejected": "moved"}),
        (PHOTOGRAPH, {"accepted": True}),
    ):
        log.append(item, change, who="ada", expected=0, study=study)
    incomplete = {
        "observations": [{"name": "waiting", "finger": "synthetic_pad", "file": "synthetic/truth.csv"}],
        "scales": {"camera_2": {"coin": "coin.png"}},
        "fingers": [{"name": "thumb", "photographs": [{"file": "synthetic/photograph_palmar.jpg"}]}],
        "sequences": [{"name": "press", "path": "synthetic", "scale": {"coin": "coin.png"}}],
        "curves": [{"finger": "synthetic_pad", "file": "synthetic/truth.csv"}],
    }
    text = f"{manifest.read_text(encoding='utf-8')}\n{tomlkit.dumps(incomplete)}"
    manifest.write_text(text, encoding="utf-8")


def _changed(value: Any, rng: random.Random) -> Any:
    """Return a document with one of its values changed."""
    places = list(_places(value))
    if not places:
        return rng.choice(ODD)
    home, key = rng.choice(places)
    kind = rng.randrange(5)
    if kind == 0:
        del home[key]
    elif kind == 1 and isinstance(home, dict):
        home[f"{key}{rng.choice(('_', 's', ' ', 'é'))}"] = home.pop(key)
    elif kind == 2:
        home[key] = rng.choice((str, lambda it: [it], lambda it: {"name": it}))(home[key])
    elif kind == 3:
        home[key] = rng.choice(places)[0]
    else:
        home[key] = rng.choice(ODD)
    return value


def _places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Yield each container in a document with each of its keys."""
    for key, item in value.items() if isinstance(value, dict) else enumerate(value):
        yield value, key
        if isinstance(item, dict | list):
            yield from _places(item)


def in_toml(text: str, rng: random.Random) -> str:
    """Return TOML with one of its values changed."""
    document = _changed(tomllib.loads(text), rng)
    return tomlkit.dumps(_without_none(document))


def _without_none(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_none(item) for key, item in value.items() if item is not None}
    return [_without_none(item) for item in value if item is not None] if isinstance(value, list) else value


def in_json(text: str, rng: random.Random) -> str:
    """Return JSON with one of its values changed."""
    return json.dumps(_changed(json.loads(text), rng))


def _in_lines(text: str, rng: random.Random) -> str:
    lines = text.splitlines()
    number = rng.randrange(len(lines))
    lines[number] = in_json(lines[number], rng)
    return "\n".join(lines) + "\n"


def in_cells(text: str, rng: random.Random) -> str:
    """Return CSV with one of its cells changed."""
    rows = list(csv.reader(io.StringIO(text)))
    row = rng.choice(rows)
    row[rng.randrange(len(row))] = str(rng.choice(ODD))
    file = io.StringIO()
    csv.writer(file).writerows(rows)
    return file.getvalue()


def in_bytes(content: bytes, rng: random.Random) -> bytes:
    """Return bytes with some cut out, put in, doubled or changed."""
    start = rng.randrange(len(content) + 1)
    end = min(len(content), start + rng.choice((1, 3, 50, 100_000)))
    put = rng.choice((b"", bytes(3), rng.randbytes(4), 2 * content[start:end], b'"', b"\n[[x]]\n", b"\xff"))
    return content[:start] + put + content[end:]


# How values are changed in a file, by its ending.
_CHANGES: Final = {".toml": in_toml, ".csv": in_cells, ".json": in_json, ".jsonl": _in_lines}


def damaged(name: str, content: bytes, rng: random.Random) -> bytes:
    """Return a file's content with one of its values or some of its bytes changed."""
    suffix = Path(name).suffix
    if suffix in _CHANGES and rng.random() >= 0.15:
        # what cannot be written cannot be read either
        with suppress(ValueError, TypeError, RecursionError, IndexError, AttributeError, csv.Error):
            return _CHANGES[suffix](content.decode(), rng).encode("utf-8", "surrogateescape")
    return in_bytes(content, rng)


# Files of a study, and how often each is chosen.
TARGETS: Final = {
    "study.toml": 15, "observations.csv": 3, CORRECTIONS_NAME: 3, "results/summary.json": 4,
    "results/results.csv": 4, "results/store.sqlite": 1,
}  # fmt: skip


def mutated(originals: dict[str, bytes], seed: int) -> dict[str, bytes | None]:
    """Return the new contents of one to three files of a study, None for one that is gone."""
    rng = random.Random(seed)
    found: dict[str, bytes | None] = {}
    for name in rng.choices([*TARGETS], [*TARGETS.values()], k=rng.choice((1, 1, 2, 3))):
        before = found.get(name, originals[name])
        found[name] = None if before is None or rng.random() < 0.01 else damaged(name, before, rng)
    return found


@dataclass(slots=True)
class Outcomes:
    """How often each thing happened, as the status of an answer, and what the program is to blame for."""

    counts: Counter[Any] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)


@cache
def routes() -> list[tuple[str, dict[str, Any]]]:
    """Return the path and query of each question; to describe the API takes longer than to ask all."""
    found = []
    for path, operations in make_api().openapi()["paths"].items():
        if "get" in operations:
            for query in QUERIES.get(path, ({},)):
                rest = dict(query)
                found.append((path.format(study=NAME, path=rest.pop("path", "")), rest))
    return found


async def ask_all(workspace: Workspace, answers: Outcomes, label: str, *, slow: bool) -> None:
    """Ask every GET route about the study that is open, but for the events, which have no end."""
    app = httpx.ASGITransport(make_app(workspace, Access(TOKEN)), raise_app_exceptions=False)
    head = {"authorization": f"Bearer {TOKEN}"}
    async with httpx.AsyncClient(transport=app, base_url="http://127.0.0.1", headers=head) as client:
        for path, query in routes():
            if path == EVENTS or (path in SLOW and not slow):
                continue
            try:
                answer = await asyncio.wait_for(client.get(path, params=query), PATIENCE_S)
                status, body = answer.status_code, answer.text[:300]
            except TimeoutError:
                status, body = 0, f"no answer within {PATIENCE_S:g} s"
            answers.counts[status] += 1
            if not 200 <= status < 500:
                answers.faults.append(f"{label}: {path} {query}: {status} {body}")


def ask_mutated(folder: Path, count: int) -> Outcomes:
    """Change a study `count` times, and ask every GET route each time; the folder is as before in the end.

    Every other study is opened before it is changed. Routes that cost much are asked of the first.
    """
    originals = {name: (folder / name).read_bytes() for name in TARGETS}
    answers = Outcomes()
    for seed in range(count):
        new = mutated(originals, seed)
        workspace = Workspace(folder.parent)
        if open_before := seed % 2 == 0:
            workspace.open_folder(folder)
        for name, content in new.items():
            _put(folder / name, content)
        try:
            if not open_before:
                workspace.open_folder(folder)
            label = f"seed {seed} ({', '.join(new)})"
            asking = ask_all(workspace, answers, label, slow=seed == 0)
            with ThreadPoolExecutor(1) as thread:  # this one may have an event loop already
                thread.submit(asyncio.run, asking).result()
        except FingerpadError:
            pass  # refused in words
        finally:
            workspace.close()
            for name in new:
                _put(folder / name, originals[name])
    return answers


def _put(path: Path, content: bytes | None) -> None:
    path.unlink(missing_ok=True)
    if content is not None:
        path.write_bytes(content)
