"""Study folders damaged at random and asked through the page.

Keys, values and types of the manifest, its spreadsheet, corrections and results are changed, and so are their
bytes. Every GET route must answer what it can in time, and say in words what it cannot.
"""

import asyncio
import random
import re
from collections import Counter
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
# Values that are right somewhere and wrong elsewhere, as JSON and mostly TOML write them.
ODD: Final = (
    "0", "-1", "1", f"{2**63 - 1}", "1e308", "-0.0", "NaN", "inf", "true", "false", "null", '""', '"x"',
    r'"\u0000"', '"../a.png"', '"ü☃"', '"/dev/zero"', '"."', '"=1+1"', '"a/b"', '"#"', '"left_index_ellipse"',
    f'"{300 * "a"}"', "[]", "[[]]", "[1, 2]", "{}", '["a", "a"]',
)  # fmt: skip
# Keys, values and cells: quoted, or up to what ends them.
_WORD: Final = re.compile(r'"(?:[^"\\\n]|\\.)*"|[^\s",=:\[\]{}]+')
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


def in_words(text: str, rng: random.Random) -> str:
    """Return JSON, TOML or CSV with a key, value or cell gone, odd, renamed, wrapped or doubled."""
    words = [*_WORD.finditer(text)]
    one, other = rng.choice(words), rng.choice(words)
    key = one[0].strip('"') + rng.choice(("_", "s", "é"))
    odd, wrapped = rng.choice(ODD), f"[{one[0]}]"
    new = rng.choice(("", odd, odd, f'"{key}"' if one[0][0] == '"' else key, wrapped, other[0]))
    return text[: one.start()] + new + text[one.end() :]


def in_bytes(content: bytes, rng: random.Random) -> bytes:
    """Return bytes with some cut out, put in, doubled or changed."""
    start = rng.randrange(len(content) + 1)
    end = min(len(content), start + rng.choice((1, 3, 50, 100_000)))
    put = rng.choice((b"", bytes(3), rng.randbytes(4), 2 * content[start:end], b'"', b"\n[[x]]\n", b"\xff"))
    return content[:start] + put + content[end:]


def damaged(content: bytes, rng: random.Random) -> bytes:
    """Return a file's content with one of its words or some of its bytes changed."""
    if rng.random() >= 0.15:
        with suppress(UnicodeDecodeError, IndexError):  # no text, or no word in it
            return in_words(content.decode(), rng).encode()
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
        found[name] = None if before is None or rng.random() < 0.01 else damaged(before, rng)
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
