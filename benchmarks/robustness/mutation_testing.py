"""Mutation testing of the science packages: ``python -m benchmarks.robustness.mutation_testing geometry``.

Each mutant is one change by an operator of Cosmic Ray (another sign, comparison, number, truth value …) to
a copy of the code. It survives if all tests of its package that reach it pass: testmon tells which these
are, and runs the fastest first, until 20 s of processor time are spent. Annotations, decorators, imports,
errors and f-strings are not mutated. ``pip install cosmic-ray pytest-testmon`` first. (mutmut leaves out
properties, cached functions and the constants of modules, where much of the science stands.)
"""

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import time
import tomllib
from collections import defaultdict
from collections.abc import Sequence
from contextlib import chdir
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, TypeAlias

import pytest

Place: TypeAlias = tuple[int, int]

ROOT: Final = Path(__file__).parents[2]
# Survivors that behave as the original, each with its reason.
EQUIVALENT: Final = Path(__file__).with_suffix(".toml")
SECONDS: Final = 20
RESULTS_TESTS: Final = (
    "compare curves export layer methods corrected outline_radius pipeline pooling repeats "
    "result_set rows table validity"
)
_OF_RESULTS = [f"tests/study/test_{name}.py" for name in RESULTS_TESTS.split()]
_ALONE: Final = "geometry", "contact", "uncertainty", "loading"
PACKAGES: Final = {name: (f"src/fingerpad/{name}", [f"tests/{name}"]) for name in _ALONE} | {
    "results": ("src/fingerpad/study/results", _OF_RESULTS)
}
# What two operators replace each other within a row: between rows most mutants fail at once.
_ROWS: Final = ("Add Sub Mul Div FloorDiv Mod Pow", "BitOr BitAnd", "Eq NotEq Lt LtE Gt GtE", "Is IsNot")
_SINGLE: Final = (
    "AddNot NumberReplacer ReplaceAndWithOr ReplaceBreakWithContinue ReplaceContinueWithBreak "
    "ReplaceFalseWithTrue ReplaceOrWithAnd ReplaceTrueWithFalse ReplaceUnaryOperator_Delete_Invert "
    "ReplaceUnaryOperator_Delete_Not ReplaceUnaryOperator_Delete_USub ZeroIterationForLoop"
)


def _is_tried(operator: str) -> bool:
    """Whether an operator, as core/ReplaceBinaryOperator_Add_Sub, makes mutants that are worth a test."""
    name, *changed = operator.removeprefix("core/").split("_")
    within_row = len(changed) == 2 and any(set(changed) <= set(row.split()) for row in _ROWS)
    return within_row or "_".join([name, *changed]) in _SINGLE.split()


@cache
def _spared(path: Path) -> list[tuple[Place, Place]]:
    """Return the first and last place (line, column in characters) of each part that is not mutated."""
    source, found = path.read_text(encoding="utf-8"), []
    lines = source.splitlines()
    for node in ast.walk(ast.parse(source)):
        parts = [getattr(node, "annotation", None), getattr(node, "returns", None)]
        parts += getattr(node, "decorator_list", [])
        name = node.name if isinstance(node, ast.FunctionDef) else ""
        in_words = name.startswith(("__repr", "__str", "_repr", "summary"))
        if in_words or isinstance(node, ast.Raise | ast.JoinedStr | ast.Import | ast.ImportFrom):
            parts.append(node)
        for part in filter(None, parts):
            ends = (part.lineno, part.col_offset), (part.end_lineno, part.end_col_offset)
            first, last = ((row, len(lines[row - 1].encode()[:column].decode())) for row, column in ends)
            found.append((first, last))
    return found


def sample_mutants(items: Sequence[Any], count: int, seed: int) -> list[Any]:
    """Draw mutants of each module in proportion to its places, at least one."""
    places: dict[Path, dict[Place, list[Any]]] = defaultdict(lambda: defaultdict(list))
    for item in items:
        (mutation,) = item.mutations
        spared = any(first <= mutation.start_pos < last for first, last in _spared(mutation.module_path))
        if _is_tried(mutation.operator_name) and not spared:
            places[mutation.module_path][mutation.start_pos].append(item)
    rng, total = random.Random(seed), sum(map(len, places.values()))
    return [
        rng.choice(found[place])
        for _, found in sorted(places.items())
        for place in rng.sample(sorted(found), max(1, round(count * len(found) / total)))
    ]


def pytest_runtest_teardown(item: pytest.Item) -> None:
    """Stop where the tests of a mutant have taken their time: this module is a plugin of theirs."""
    if "MUTANT" in os.environ and time.process_time() > SECONDS:
        item.session.shouldstop = "time is spent"


def run_package(name: str, session: Path, count: int, seed: int, *, survivors: bool) -> None:
    """Test mutants of a package, a new sample or what survived before, and keep what became of each."""
    from cosmic_ray.commands import init  # noqa: PLC0415 (need not be installed)
    from cosmic_ray.mutating import mutate_and_test  # noqa: PLC0415
    from cosmic_ray.work_db import use_db  # noqa: PLC0415

    folder, tests = PACKAGES[name]
    command = [sys.executable, "-m", "pytest", "-xq", "-n0", "-p", "testmon.pytest_testmon"]
    with TemporaryDirectory(prefix="mutants-") as copy, chdir(copy), use_db(session) as database:
        for part in ("src", "tests", "benchmarks", "examples", "docs"):
            shutil.copytree(ROOT / part, part, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(ROOT / "pyproject.toml", copy)
        os.environ |= {"PYTHONPATH": f"{copy}/src:{copy}", "PYTHONDONTWRITEBYTECODE": "1"}
        command += ["--testmon-forceselect", folder, *(path for path in tests if Path(path).exists())]
        if subprocess.run(command, check=False).returncode:
            raise SystemExit("the tests fail without a mutant")
        if survivors:
            survived = {job for job, result in database.results if not result.is_killed}
            sample = [item for item in database.work_items if item.job_id in survived]
        else:
            init(sorted(Path(folder).rglob("*.py")), database, {})
            sample = sample_mutants(database.work_items, count, seed)
        # That no test reaches a mutant (5), and that their time is spent (2), are no failures of a test.
        quoted = " ".join([*command, "--testmon-nocollect", "-p", __spec__.name])
        tried = f"sh -c 'MUTANT=1 {quoted}; case $? in 0|2|5) exit 0;; esac; exit 1'"
        for number, item in enumerate(sample, 1):
            result = mutate_and_test(item.mutations, tried, 10 * SECONDS)
            if "SyntaxError" not in result.output:  # such a mutant is none
                database.set_result(item.job_id, result)
            (mutation,) = item.mutations
            where = f"{mutation.module_path}:{mutation.start_pos[0]} {mutation.operator_name}"
            print(f"{number}/{len(sample)} {where}  # {result.test_outcome.value}", flush=True)


def print_score(name: str, session: Path) -> None:
    """Print how many of a package's mutants survive, and those that are not known to be equivalent."""
    from cosmic_ray.work_db import use_db  # noqa: PLC0415

    known = tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))["mutants"]
    equivalent = {(one["file"], one["after"]) for one in known}
    with use_db(session) as database:
        modules = {item.job_id: str(item.mutations[0].module_path) for item in database.work_items}
        results = [(modules[job], result) for job, result in database.results]
    survived = [(module, result.diff) for module, result in results if not result.is_killed]
    left = [
        diff
        for module, diff in survived
        if not any((module, line[1:].strip()) in equivalent for line in diff.splitlines() if line[:1] == "+")
    ]
    killed, alike = len(results) - len(survived), len(survived) - len(left)
    print(f"\n{name}: {len(results)} mutants, {killed} killed, {alike} equivalent, ", end="")
    print(f"{len(left)} survive: {1 - len(left) / max(1, killed + len(left)):.0%}", *left, sep="\n")


def main() -> None:
    """Draw and test mutants, keep what became of them, and print the score of each package."""
    parser = argparse.ArgumentParser(prog=f"python -m {__spec__.name}", description=main.__doc__)
    names = ", ".join(PACKAGES)
    parser.add_argument("packages", nargs="*", default=[*PACKAGES], metavar="package", help=names)
    parser.add_argument("--count", type=int, default=80, help="mutants of each package (default: 80)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("build/mutants"), help="folder of what was found")
    parser.add_argument("--survivors", action="store_true", help="test again only what survived before")
    asked = parser.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    out = asked.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    for name in asked.packages:
        session = out / f"{name}.sqlite"
        run_package(name, session, asked.count, asked.seed, survivors=asked.survivors)
        print_score(name, session)


if __name__ == "__main__":
    main()
