"""The command line, as ``fingerpad`` or ``python -m fingerpad``."""

import os
import sys

from fingerpad._threads import ONE_THREAD

_OPTIONAL = {
    "PIL",
    "cv2",
    "jinja2",
    "filelock",
    "markupsafe",
    "matplotlib",
    "pydantic",
    "rich",
    "tifffile",
    "typer",
}


def main() -> None:
    """Run the command line, or say what it needs."""
    if not ONE_THREAD.keys() & os.environ.keys():
        os.environ.update(ONE_THREAD)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="replace")  # type: ignore[union-attr] # a console that lacks ℓ still gets the numbers
    try:
        from fingerpad.cli import app

        app()
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] not in _OPTIONAL:
            raise
        _refuse(f"this needs the package {error.name}: pip install 'fingerpad[study]'")
    except KeyboardInterrupt:
        print("fingerpad: interrupted", file=sys.stderr)
        sys.exit(130)
    except OSError as error:
        _refuse(f"cannot write what was asked for ({error.strerror})")


def _refuse(message: str) -> None:
    print(f"fingerpad: {message}", file=sys.stderr)
    sys.exit(2)


if __name__ == "__main__":
    main()
