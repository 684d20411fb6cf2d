"""The command line, called in this process."""

import json
from typing import Any

from typer.testing import CliRunner

from fingerpad.cli import app


def run(*arguments: object) -> tuple[int, str, str]:
    """Return the exit code of a command, and what it wrote on either stream; no exception leaves it."""
    result = CliRunner().invoke(app, [*map(str, arguments)])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.stdout, result.stderr


def run_json(*arguments: object) -> Any:
    """Return what a command that has nothing to warn of prints with ``--json``."""
    code, out, err = run(*arguments, "--json")
    assert (code, err) == (0, "")
    return json.loads(out)


def printed(*arguments: object) -> str:
    """Return what a command prints that ends well, whatever it notes besides."""
    code, out, err = run(*arguments)
    assert code == 0, err
    return out


def refusal(*arguments: object) -> str:
    """Return on one line what a command says that refuses its arguments and prints nothing."""
    code, out, err = run(*arguments)
    assert (code, out, "Traceback" in err) == (2, "", False), err
    return " ".join(err.replace("│", " ").split())
