"""Mutation testing of the science packages: ``python -m benchmarks.robustness.mutation_testing geometry``.

Each mutant is one change by an operator of Cosmic Ray (another sign, comparison, number, truth value …) to
a copy of the source. It survives if all tests of its package that reach its line pass. One run with coverage
tells which these are; they run fastest first, at most 20 s of processor time in all, in a process forked from
one that has imported the libraries. Annotations, decorators, imports, errors and f-strings are not mutated.
``pip install cosmic-ray coverage`` first.
"""

import argparse
import ast
import compileall
import importlib
import json
import os
import random
import resource
import shutil
import signal
import sys
import time
import tomllib
import traceback
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from py_compile import PycInvalidationMode
from tempfile import TemporaryDirectory
from typing import Any, Final, TypeAlias

import pytest

Mutant: TypeAlias = dict[str, Any]
Place: TypeAlias = tuple[int, int]

ROOT: Final = Path(__file__).parents[2]
# Survivors that behave as the original, each with its reason.
EQUIVALENT: Final = Path(__file__).with_suffix(".toml")
SECONDS, MEMORY = 20, 6 << 30
RESULTS_TESTS: Final = (
    "check compare curves digest export layer methods operators outline_radius pipeline pooling repeats "
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


def _in_fork(work: Callable[[], int], seconds: float) -> int | None:
    """Return the exit code of a function called in a forked process, None where it took too long."""
    child = os.fork()
    if not child:
        code = 70
        try:
            os.setsid()
            resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 5))
            os.dup2(os.open("output.txt", os.O_CREAT | os.O_TRUNC | os.O_WRONLY), 1)
            os.dup2(1, 2)
            code = work()
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(code)
    end = time.monotonic() + 5 * seconds
    while not (ended := os.waitpid(child, os.WNOHANG))[0] and time.monotonic() < end:
        time.sleep(0.02)
    with suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)
    if not ended[0]:
        os.waitpid(child, 0)
        return None
    return os.WEXITSTATUS(ended[1]) if os.WIFEXITED(ended[1]) else None


def _pytest(copy: Path, paths: list[str], plugin: object) -> int:
    """Run tests of the copy in this process and return pytest's exit code."""
    sys.path[:0] = [str(copy), str(copy / "src")]
    os.environ["PYTHONPATH"] = str(copy / "src")
    for name in [name for name in sys.modules if name.split(".")[0] in {"benchmarks", "fingerpad"}]:
        del sys.modules[name]
    options = "-x -q -n 0 -p no:cacheprovider -W ignore::pytest.PytestAssertRewriteWarning"
    return int(pytest.main([*options.split(), *paths], plugins=[plugin]))


def _processor_time() -> float:
    return sum(os.times()[:4])  # that of processes which have ended included


class _Trace:
    """Tells coverage which test runs or which fixture of several tests, and notes the time of each test."""

    def __init__(self, coverage: Any) -> None:
        self.coverage, self.seconds, self.fixtures = coverage, dict[str, float](), dict[str, list[str]]()

    def pytest_runtest_setup(self, item: Any) -> None:
        self.test, self.start = item.nodeid, _processor_time()
        self.fixtures[item.nodeid] = list(getattr(item, "fixturenames", ()))
        for module in [of for name, of in sys.modules.items() if name.startswith("fingerpad.")]:
            for value in list(vars(module).values()):
                if hasattr(value, "cache_clear") and hasattr(value, "cache_info"):
                    value.cache_clear()  # so that each test reaches what it needs
        self.coverage.switch_context(item.nodeid)

    def pytest_fixture_setup(self, fixturedef: Any) -> None:
        if fixturedef.scope != "function":
            self.coverage.switch_context(f"fixture {fixturedef.argname}")

    def pytest_runtest_call(self) -> None:
        self.coverage.switch_context(self.test)

    def pytest_runtest_teardown(self) -> None:
        self.seconds[self.test] = _processor_time() - self.start


class _Chosen:
    """Keeps the chosen tests, in their order, and notes the one that fails."""

    def __init__(self, tests: list[str], failed: Path) -> None:
        self.order, self.failed = {test: place for place, test in enumerate(tests)}, failed

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        items[:] = sorted((i for i in items if i.nodeid in self.order), key=lambda i: self.order[i.nodeid])

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.failed:
            self.failed.write_text(report.nodeid, encoding="utf-8")


def trace_tests(copy: Path, folder: str, paths: list[str]) -> dict[str, Any]:
    """Run all tests of a package with coverage; return the lines that each reaches, and its time."""

    def work() -> int:
        import coverage  # noqa: PLC0415

        traced = coverage.Coverage(data_file=None, include=[f"{copy / folder}/*"])
        trace = _Trace(traced)
        traced.start()
        code = _pytest(copy, paths, trace)
        traced.stop()
        data, own = traced.get_data(), {"benchmarks", "fingerpad", "tests"}
        found = {
            "lines": {
                str(Path(f).relative_to(copy)): data.contexts_by_lineno(f) for f in data.measured_files()
            },
            "seconds": trace.seconds,
            "fixtures": trace.fixtures,
            "modules": [name for name in sys.modules if name.split(".")[0] not in own],
        }
        Path("trace.json").write_text(json.dumps(found), encoding="utf-8")
        return code

    if _in_fork(work, 3600) != 0:
        raise SystemExit(f"the tests fail without a mutant:\n{Path('output.txt').read_text()[-3000:]}")
    found: dict[str, Any] = json.loads(Path("trace.json").read_text(encoding="utf-8"))
    for name in found["modules"]:
        with suppress(Exception):
            importlib.import_module(name)
    return found


def _statement_at(path: Path, line: int) -> range:
    """Return the lines of the statement that a line belongs to, of a compound one those of its head."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            last = max(node.lineno, body[0].lineno - 1) if body else node.end_lineno or node.lineno
            if node.lineno <= line <= last:
                found.append(range(node.lineno, last + 1))
    return min(found, key=len)


def tests_reaching(trace: dict[str, Any], copy: Path, mutant: Mutant) -> list[str]:
    """Return the tests that reach a mutant, fastest first, as many as fit in the time, at least one."""
    lines, contexts = trace["lines"].get(mutant["file"], {}), set[str]()
    for line in _statement_at(copy / mutant["file"], mutant["line"]):
        contexts.update(lines.get(str(line), []))
    shared = {name.removeprefix("fixture ") for name in contexts if name.startswith("fixture ")}
    chosen, left = list[str](), float(SECONDS)
    for test, seconds in sorted(trace["seconds"].items(), key=lambda pair: pair[1]):
        # Without a context a line runs when its module is imported.
        reached = "" in contexts or test in contexts or shared & set(trace["fixtures"][test])
        if reached and (seconds < left or not chosen):
            chosen.append(test)
            left -= seconds
    return chosen


def outcome_of(copy: Path, mutant: Mutant, tests: list[str]) -> str:
    """Return ``killed`` with the test that fails, or ``survived``."""
    if not tests:
        return "survived: no test reaches it"
    path, failed = copy / mutant["file"], copy / "failed.txt"
    failed.unlink(missing_ok=True)
    source = path.read_text(encoding="utf-8")
    path.write_text(mutate(source, mutant), encoding="utf-8")

    def work() -> int:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        return _pytest(copy, sorted({test.split("::")[0] for test in tests}), _Chosen(tests, failed))

    try:
        code = _in_fork(work, 2 * SECONDS)
    finally:
        path.write_text(source, encoding="utf-8")
    if code == 0:
        return "survived"
    if code is not None and code > pytest.ExitCode.USAGE_ERROR:
        raise SystemExit(f"pytest did not run:\n{Path('output.txt').read_text()[-3000:]}")
    return f"killed: {failed.read_text(encoding='utf-8') if failed.exists() else code or 'time'}"


def run_package(name: str, count: int, seed: int, sample: list[Mutant] | None) -> list[Mutant]:
    """Return a sample of a package's mutants, a new one unless given, with what became of each."""
    folder, paths = PACKAGES[name]
    with TemporaryDirectory(prefix="mutants-") as temporary:
        copy = Path(temporary).resolve()
        for part in ("src", "tests", "benchmarks", "examples"):
            shutil.copytree(ROOT / part, copy / part, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(ROOT / "pyproject.toml", copy)
        compileall.compile_dir(copy / "src", quiet=2, invalidation_mode=PycInvalidationMode.CHECKED_HASH)
        os.chdir(copy)
        sample = sample or sample_mutants(copy, folder, count, seed)
        trace = trace_tests(copy, folder, [folder, *(path for path in paths if (copy / path).exists())])
        for number, mutant in enumerate(sample, 1):
            mutant["outcome"] = outcome_of(copy, mutant, tests_reaching(trace, copy, mutant))
            where = f"{mutant['file'].removeprefix('src/fingerpad/')}:{mutant['line']}"
            print(f"{number}/{len(sample)} {where} {mutant['after']}  # {mutant['outcome']}", flush=True)
        os.chdir(ROOT)
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
