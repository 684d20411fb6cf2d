"""Measure again what the documentation states, or list what there is.

A table is printed; with --store it also becomes benchmarks/results/NAME.md, which the documentation
includes. Without keys the sample is that of the stored table.
"""

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
from typing import Any

from benchmarks import RESULTS, ROOT, modules

Sample = dict[str, int | float | str | bool]


class _Copied(StringIO):
    """Text that is shown at once, and kept."""

    def __init__(self) -> None:
        super().__init__()
        self.shown = sys.stdout

    def write(self, text: str) -> int:
        self.shown.write(text)
        self.shown.flush()
        return super().write(text)


def _commit() -> str:
    """Return the commit that is measured, and whether files beside the results differ from it."""

    def git(*words: str) -> str:
        return subprocess.run(
            ["git", *words], cwd=ROOT, capture_output=True, text=True, check=False
        ).stdout.strip()

    changed = git("status", "--porcelain", "-uno", "--", ".", ":!benchmarks/results")
    return git("rev-parse", "--short=8", "HEAD") + ("-dirty" if changed else "")


def _module(name: str) -> Any:
    try:
        return importlib.import_module(modules()[name])
    except ModuleNotFoundError as error:
        sys.exit(f"{name} needs the package {error.name}: `make setup` installs what benchmarks need")


def drawn(name: str, module: Any, sample: Sample) -> Sample:
    """Return all arguments of a benchmark, those that are not given by their defaults."""
    try:
        bound = inspect.signature(module.report).bind(**sample)
    except TypeError as error:
        sys.exit(f"{name}: {error}; `python -m benchmarks {name} --help` lists its keys")
    bound.apply_defaults()
    return bound.arguments


def sample_words(sample: Sample) -> str:
    """Return a sample as the foot of a stored table states it: "; count 24; seed 8"."""
    return "".join(
        f"; {key.replace('_', ' ')} {value}"
        for key, value in sample.items()
        if value and not isinstance(value, str)
    )


def measure(name: str, given: Sample, *, store: bool = False) -> None:
    """Run a benchmark, and print its table and the foot that states how it was made; store them if asked."""
    module = _module(name)
    sample = drawn(name, module, given)
    commit = _commit()
    with redirect_stdout(_Copied()) as shown:
        module.report(**sample)
    command = " ".join([name, *(f"{key}={value}" for key, value in given.items())])
    foot = f"*`python -m benchmarks {command}`, {date.today()}, commit {commit}{sample_words(sample)}.*"
    print(f"\n{foot}")
    if store:
        text = shown.getvalue().strip("\n")
        # A table in Markdown stands as one; aligned columns keep their spaces.
        body = text if "|---|" in text else f"```text\n{text}\n```"
        (RESULTS / f"{name}.md").write_text(f"{body}\n\n{foot}\n", encoding="utf-8")


def explain(name: str) -> None:
    """Print the keys of a benchmark with their defaults, and what it measures."""
    module = _module(name)
    keys = (f"[{key}={one.default}]" for key, one in inspect.signature(module.report).parameters.items())
    print(" ".join(["usage: python -m benchmarks", name, *keys, "[--store]"]))
    for text in (module.__doc__, module.report.__doc__):
        print(f"\n{inspect.cleandoc(text)}")
    print(f"\nThe defaults are the sample of benchmarks/results/{name}.md, which --store replaces.")


def _value(text: str) -> int | float | str | bool:
    try:
        value: int | float | str | bool = ast.literal_eval(text)
    except (SyntaxError, ValueError):
        return text
    return value


def main() -> None:
    """Run what the command line asks for."""
    known = modules()
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        add_help=False,
    )
    parser.add_argument("name", nargs="?", choices=[*known, "all"], metavar="NAME", help="what to measure")
    parser.add_argument("sample", nargs="*", metavar="KEY=VALUE", help="another sample, as seed=3")
    parser.add_argument("--store", action="store_true", help="write the table into benchmarks/results")
    parser.add_argument("-h", "--help", action="store_true", help="show this, or the keys of NAME, and exit")
    asked = parser.parse_intermixed_args()
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it
    if asked.help and asked.name in known:
        explain(asked.name)
    elif asked.help:
        parser.print_help()
    elif asked.name is None:
        for name, module in known.items():
            source = ROOT.joinpath(*module.split(".")).with_suffix(".py").read_text(encoding="utf-8")
            print(f"{name:<20} {(ast.get_docstring(ast.parse(source)) or '').splitlines()[0]}")
    else:
        given = {}
        for text in asked.sample:
            key, equals, value = text.partition("=")
            if not equals:
                parser.error(f"{text}: write KEY=VALUE, as seed=3")
            given[key] = _value(value)
        for name in known if asked.name == "all" else [asked.name]:
            print(f"\n{name}", file=sys.stderr)
            measure(name, given, store=asked.store)


if __name__ == "__main__":
    main()
