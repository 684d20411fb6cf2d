"""Mutation testing of the science packages: ``python -m benchmarks.robustness.mutation_testing geometry``.

Each mutant is one change by an operator of Cosmic Ray (another sign, comparison, number, truth value …) to
a copy of the code. It survives if all tests of its package that reach it pass: testmon tells which these
are, and runs the fastest first, until 20 s of processor time are spent. Annotations, decorators, imports,
errors and f-strings are not mutated. ``pip install cosmic-ray pytest-testmon`` first. (mutmut leaves out
properties, cached functions and the constants of modules, where much of the science stands.)
"""

import argparse
import ast
import json
import os
import random
import shutil
import subprocess
import sys
import time
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, TypeAlias

import pytest

Mutant: TypeAlias = dict[str, Any]
Place: TypeAlias = tuple[int, int]

ROOT: Final = Path(__file__).parents[2]
# Survivors that behave as the original, each with its reason.
EQUIVALENT: Final = Path(__file__).with_suffix(".toml")
SECONDS: Final = 20
RESULTS_TESTS: Final = (
    "compare curves export layer methods operators outline_radius pipeline pooling repeats "
    "result_set rows table validity"
)
PACKAGES: Final = {
    **{name: (f"src/fingerpad/{name}", [f"tests/{name}"]) for name in ("geometry", "contact")},
    **{name: (f"src/fingerpad/{name}", [f"tests/{name}"]) for name in ("uncertainty", "loading")},
    "results": (
        "src/fingerpad/study/results", [f"tests/study/test_{name}.py" for name in RESULTS_TESTS.split()]
    ),
}  # fmt: skip
# Operators replace each other within a row: between rows most mutants fail at once.
_ROWS: Final = ("Add Sub Mul Div FloorDiv Mod Pow", "BitOr BitAnd", "Eq NotEq Lt LtE Gt GtE", "Is IsNot")
_SINGLE: Final = (
    "AddNot NumberReplacer ReplaceAndWithOr ReplaceBreakWithContinue ReplaceContinueWithBreak "
    "ReplaceFalseWithTrue ReplaceOrWithAnd ReplaceTrueWithFalse ReplaceUnaryOperator_Delete_Invert "
    "ReplaceUnaryOperator_Delete_Not ReplaceUnaryOperator_Delete_USub ZeroIterationForLoop"
)


def _operators() -> dict[str, Any]:
    from cosmic_ray.operators.provider import OperatorProvider  # noqa: PLC0415 (need not be installed)

    provider = OperatorProvider()
    pairs = [{one, other} for row in map(str.split, _ROWS) for one in row for other in row if one != other]
    swaps = [name for name in provider if name.count("_") == 2 and set(name.split("_")[1:]) in pairs]
    return {name: provider[name]() for name in (*swaps, *_SINGLE.split())}


def _spared(source: str) -> Iterator[tuple[Place, Place]]:
    """Yield the first and last place (line, column in characters) of what is not mutated."""
    lines = source.splitlines()
    for node in ast.walk(ast.parse(source)):
        parts = [getattr(node, "annotation", None), getattr(node, "returns", None)]
        parts += getattr(node, "decorator_list", [])
        if isinstance(node, ast.Raise | ast.JoinedStr | ast.Import | ast.ImportFrom):
            parts.append(node)
        if isinstance(node, ast.FunctionDef) and node.name.startswith(
            ("__repr", "__str", "_repr", "summary")
        ):
            parts.append(node)
        for part in filter(None, parts):
            ends = (part.lineno, part.col_offset), (part.end_lineno, part.end_col_offset)
            first, last = ((row, len(lines[row - 1].encode()[:column].decode())) for row, column in ends)
            yield first, last


def mutants_of(path: Path) -> dict[Place, list[Mutant]]:
    """Return all mutants of a module by their place."""
    from cosmic_ray.ast import ast_nodes, get_ast  # noqa: PLC0415

    source = path.read_text(encoding="utf-8")
    spared, counts = list(_spared(source)), Counter[str]()
    found: dict[Place, list[Mutant]] = defaultdict(list)
    operators = _operators()
    for node in ast_nodes(get_ast(source)):
        for name, operator in operators.items():
            for start, _ in operator.mutation_positions(node):
                if not any(first <= start < last for first, last in spared):
                    found[start].append({"line": start[0], "operator": name, "occurrence": counts[name]})
                counts[name] += 1
    return found


def mutate(source: str, mutant: Mutant) -> str:
    """Return the source with one change."""
    from cosmic_ray.mutating import mutate_code  # noqa: PLC0415

    return str(mutate_code(source, _operators()[mutant["operator"]], mutant["occurrence"]))


def sample_mutants(copy: Path, folder: str, count: int, seed: int) -> list[Mutant]:
    """Draw mutants of each module in proportion to its places, at least one."""
    rng, sample = random.Random(seed), []
    modules = {path: mutants_of(path) for path in sorted((copy / folder).rglob("*.py"))}
    total = sum(map(len, modules.values()))
    for path, places in modules.items():
        source, drawn = path.read_text(encoding="utf-8"), []
        for place in rng.sample(sorted(places), len(places)):
            mutant = {"file": str(path.relative_to(copy)), **rng.choice(places[place])}
            changed = mutate(source, mutant)
            with suppress(SyntaxError):
                compile(changed, str(path), "exec")
                lines = zip(source.splitlines(), changed.splitlines(), strict=False)
                before, after = next(pair for pair in lines if pair[0] != pair[1])
                drawn.append({**mutant, "before": before.strip(), "after": after.strip()})
            if len(drawn) >= max(1, round(count * len(places) / total)):
                break
        sample += drawn
    return sample


def pytest_runtest_teardown(item: pytest.Item) -> None:
    """Stop where the tests of a mutant have taken their time: this module is a plugin of theirs."""
    if "MUTANT" in os.environ and time.process_time() > SECONDS:
        item.session.shouldstop = "time is spent"


def _pytest(
    copy: Path, paths: list[str], *options: str, seconds: float | None = None, **environment: str
) -> tuple[int, str]:
    """Run those tests of the copy that a change reaches; return pytest's exit code and what it printed."""
    command = ["-m", "pytest", "-xq", "-n0", "-p", "testmon.pytest_testmon", "--testmon-forceselect"]
    known = {"PYTHONPATH": f"{copy / 'src'}:{copy}", "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, *command, *options, *paths],
        cwd=copy,
        env=os.environ | known | environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=seconds,
    )
    return done.returncode, done.stdout + done.stderr


def outcome_of(copy: Path, mutant: Mutant, paths: list[str]) -> str:
    """Return ``killed`` with the test that fails, or ``survived``."""
    path = copy / mutant["file"]
    source = path.read_text(encoding="utf-8")
    path.write_text(mutate(source, mutant), encoding="utf-8")
    options = "--testmon-nocollect", "-p", __spec__.name
    try:
        code, printed = _pytest(copy, paths, *options, seconds=10 * SECONDS, MUTANT="1")
    except subprocess.TimeoutExpired:
        return "killed: time"
    finally:
        path.write_text(source, encoding="utf-8")
    if code == pytest.ExitCode.NO_TESTS_COLLECTED:
        return "survived: no test reaches it"
    if code in {pytest.ExitCode.OK, pytest.ExitCode.INTERRUPTED}:
        return "survived"
    failed = [line for line in printed.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return f"killed: {failed[0] if failed else code}"


def run_package(name: str, count: int, seed: int, sample: list[Mutant] | None) -> list[Mutant]:
    """Return a sample of a package's mutants, a new one unless given, with what became of each."""
    folder, paths = PACKAGES[name]
    with TemporaryDirectory(prefix="mutants-") as temporary:
        copy = Path(temporary).resolve()
        for part in ("src", "tests", "benchmarks", "examples", "docs"):
            shutil.copytree(ROOT / part, copy / part, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(ROOT / "pyproject.toml", copy)
        paths = [folder, *(path for path in paths if (copy / path).exists())]
        code, printed = _pytest(copy, paths)
        if code:
            raise SystemExit(f"the tests fail without a mutant:\n{printed[-3000:]}")
        sample = sample or sample_mutants(copy, folder, count, seed)
        for number, mutant in enumerate(sample, 1):
            mutant["outcome"] = outcome_of(copy, mutant, paths)
            where = f"{mutant['file'].removeprefix('src/fingerpad/')}:{mutant['line']}"
            print(f"{number}/{len(sample)} {where} {mutant['after']}  # {mutant['outcome']}", flush=True)
    return sample


def print_score(name: str, sample: list[Mutant]) -> None:
    """Print how many of a package's mutants survive, and those that are not known to be equivalent."""
    known = tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))["mutants"]
    equivalent = {(one["file"], one["after"]) for one in known}
    survived = [one for one in sample if one["outcome"].startswith("survived")]
    left = [one for one in survived if (one["file"], one["after"]) not in equivalent]
    score = 1 - len(left) / max(1, len(sample) - len(survived) + len(left))
    print(f"\n{name}: {len(sample)} mutants, {len(sample) - len(survived)} killed, ", end="")
    print(f"{len(survived) - len(left)} equivalent, {len(left)} survive: {score:.0%}")
    for one in left:
        print(f"  {one['file']}:{one['line']}\n    - {one['before']}\n    + {one['after']}")


def main() -> None:
    """Draw and test mutants, write what became of them, and print the score of each package."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.robustness.mutation_testing", description=main.__doc__
    )
    parser.add_argument(
        "packages", nargs="*", default=[*PACKAGES], metavar="package", help=", ".join(PACKAGES)
    )
    parser.add_argument("--count", type=int, default=80, help="mutants of each package (default: 80)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("build/mutants"), help="folder of what was found")
    parser.add_argument("--survivors", action="store_true", help="test again only what survived before")
    asked = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    out = asked.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    for name in asked.packages:
        file, sample = out / f"{name}.json", None
        if asked.survivors:
            sample = json.loads(file.read_text(encoding="utf-8"))
            run_package(name, 0, 0, [one for one in sample if one["outcome"].startswith("survived")])
        sample = sample or run_package(name, asked.count, asked.seed, None)
        file.write_text(json.dumps(sample, indent=1, ensure_ascii=False), encoding="utf-8")
        print_score(name, sample)


if __name__ == "__main__":
    main()
