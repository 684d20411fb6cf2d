"""Measure again what the documentation states, or list what there is.

A table is printed; with --store it also becomes benchmarks/results/NAME.md, which the documentation
includes. Without options the sample is that of the stored table.
"""

import argparse
import ast
import importlib
import inspect
import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from datetime import date
from io import StringIO
from typing import Any

from benchmarks import RESULTS, ROOT, modules


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


def options_of(name: str, module: Any) -> argparse.ArgumentParser:
    """Return what reads the options of a benchmark: one for each argument of its report."""
    texts = [inspect.cleandoc(text) for text in (module.__doc__, module.report.__doc__)]
    end = f"The defaults are the sample of benchmarks/results/{name}.md, which --store replaces."
    parser = argparse.ArgumentParser(
        prog=f"python -m benchmarks {name}",
        description="\n\n".join([*texts, end]),
        formatter_class=argparse.RawTextHelpFormatter,
    )
    for key, one in inspect.signature(module.report).parameters.items():
        option = f"--{key.replace('_', '-')}"
        parser.add_argument(option, type=type(one.default), default=one.default, help="default: %(default)s")
    parser.add_argument("--store", action="store_true", help="write the table into benchmarks/results")
    return parser


def sample_words(sample: Mapping[str, object]) -> str:
    """Return a sample as the foot of a stored table states it: "; count 24; seed 8"."""
    return "".join(
        f"; {key.replace('_', ' ')} {value}"
        for key, value in sample.items()
        if value and not isinstance(value, str)
    )


def measure(name: str, options: Sequence[str]) -> None:
    """Run a benchmark, and print its table and the foot that states how it was made; store them if asked."""
    try:
        module = importlib.import_module(modules()[name])
    except ModuleNotFoundError as error:
        sys.exit(f"{name} needs the package {error.name}: `make setup` installs what benchmarks need")
    sample = vars(options_of(name, module).parse_args(options))
    store, commit = sample.pop("store"), _commit()
    with redirect_stdout(_Copied()) as shown:
        module.report(**sample)
    command = " ".join([name, *(word for word in options if word != "--store")])
    foot = f"*`python -m benchmarks {command}`, {date.today()}, commit {commit}{sample_words(sample)}.*"
    print(f"\n{foot}")
    if store:
        text = shown.getvalue().strip("\n")
        # A table in Markdown stands as one; aligned columns keep their spaces.
        body = text if "|---|" in text else f"```text\n{text}\n```"
        (RESULTS / f"{name}.md").write_text(f"{body}\n\n{foot}\n", encoding="utf-8")


def main() -> None:
    """Run what the command line asks for."""
    known = modules()
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks", description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("name", nargs="?", choices=[*known, "all"], metavar="NAME", help="what to measure")
    parser.add_argument("options", nargs=argparse.REMAINDER, help="NAME --help lists them")
    asked = parser.parse_args()
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a job in the background ignores it
    if asked.name is None:
        for name, module in known.items():
            source = ROOT.joinpath(*module.split(".")).with_suffix(".py").read_text(encoding="utf-8")
            print(f"{name:<20} {(ast.get_docstring(ast.parse(source)) or '').splitlines()[0]}")
    for name in known if asked.name == "all" else filter(None, [asked.name]):
        print(f"\n{name}", file=sys.stderr)
        measure(name, asked.options)


if __name__ == "__main__":
    main()
