"""Measure again what the documentation states, or list what there is."""

import argparse
import ast
import importlib
import inspect
import os
import signal
import subprocess
import sys
from contextlib import redirect_stdout
from datetime import date
from io import StringIO

from benchmarks import RESULTS, ROOT, modules


class _Copied(StringIO):
    """Text that is shown at once, and kept."""

    def write(self, text: str) -> int:
        sys.__stdout__.write(text)  # type: ignore[union-attr]
        sys.__stdout__.flush()  # type: ignore[union-attr]
        return super().write(text)


def _commit() -> str:
    """Return the commit that is measured, and whether files beside the results differ from it."""

    def git(*words: str) -> str:
        return subprocess.run(
            ["git", *words], cwd=ROOT, capture_output=True, text=True, check=False
        ).stdout.strip()

    changed = git("status", "--porcelain", "-uno", "--", ".", ":!benchmarks/results")
    return git("rev-parse", "--short=8", "HEAD") + ("-dirty" if changed else "")


def measure(name: str, sample: dict[str, int | str | bool]) -> None:
    """Run a benchmark, and store what it prints with its date, commit and sample."""
    report = importlib.import_module(modules()[name]).report
    try:
        drawn = inspect.signature(report).bind(**sample)
    except TypeError as error:
        sys.exit(f"{name}: {error}; it takes {inspect.signature(report)}")
    drawn.apply_defaults()
    commit = _commit()
    with redirect_stdout(_Copied()) as shown:
        report(**drawn.arguments)
    given = " ".join([name, *(f"{key}={value}" for key, value in sample.items())])
    of = [
        f"{key.replace('_', ' ')} {value}"
        for key, value in drawn.arguments.items()
        if value and not isinstance(value, str)
    ]
    head = "; ".join([f"`python -m benchmarks {given}`, {date.today()}, commit {commit}", *of])
    text = shown.getvalue().strip("\n")
    # A table in Markdown stands as one; aligned columns keep their spaces.
    body = text if "|---|" in text else f"```text\n{text}\n```"
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / f"{name}.md").write_text(f"{body}\n\n*{head}.*\n", encoding="utf-8")


def main() -> None:
    """Run what the command line asks for."""
    known = modules()
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("name", nargs="?", choices=[*known, "all"], metavar="NAME")
    parser.add_argument("sample", nargs="*", metavar="KEY=VALUE", help="arguments of its report, as seed=3")
    given = parser.parse_args()
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it
    if given.name is None:
        for name, module in known.items():
            print(f"{name:<20} {(importlib.import_module(module).__doc__ or '').splitlines()[0]}")
        return
    sample = {}
    for text in given.sample:
        key, equals, value = text.partition("=")
        if not equals:
            parser.error(f"{text}: write KEY=VALUE, as seed=3")
        try:
            sample[key] = ast.literal_eval(value)
        except (SyntaxError, ValueError):
            sample[key] = value
    for name in known if given.name == "all" else [given.name]:
        print(f"\n{name}", file=sys.stderr)
        measure(name, sample)


if __name__ == "__main__":
    main()
