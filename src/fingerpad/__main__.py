"""The command line, as ``fingerpad`` or ``python -m fingerpad``."""

import os
import signal
import sys
from _thread import interrupt_main
from contextlib import suppress
from threading import Timer
from types import TracebackType
from typing import Final, TextIO

from fingerpad._threads import ONE_THREAD
from fingerpad.exceptions import is_interrupt

# Of packages that are not always there, which extra of fingerpad has them.
_OF_STUDIES: Final = (
    *("PIL", "cattrs", "cv2", "filelock", "jinja2", "markupsafe", "matplotlib", "pandas", "pydantic"),
    *("python_calamine", "rich", "roifile", "tifffile", "typer"),
)
_OF_PAGE: Final = "fastapi", "plotly", "tomlkit", "uvicorn"
_EXTRAS: Final = {**dict.fromkeys(_OF_STUDIES, "study"), **dict.fromkeys(_OF_PAGE, "app")}
_INTERRUPTED: Final = 130


def main() -> None:
    """Run the command line; errors give an exit code and one line on stderr, no traceback."""
    code = 1
    sys.unraisablehook, sys.excepthook = _raise_interrupt_again, _show_unless_interrupt
    try:
        code = _run()
    except ModuleNotFoundError as error:
        if extra := _EXTRAS.get((error.name or "").partition(".")[0]):
            what = "the page" if extra == "app" else "this"
            _say(f"{what} needs the package {error.name}: pip install 'fingerpad[{extra}]'")
            code = 2
        else:
            _say(f"this cannot be done ({error})")
    except OSError as error:  # raised outside of commands, as for --help
        _say(f"cannot write ({error.strerror or error})")
    except (Exception, KeyboardInterrupt) as error:
        if not is_interrupt(error):
            raise
        _say("interrupted")
        code = _INTERRUPTED
    finally:
        # From here on an interrupt ends the process at once, without a traceback of what is being closed.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    flushed = [_flushed(stream) for stream in (sys.stdout, sys.stderr)]
    if code == _INTERRUPTED:
        # Compiled modules whose import was interrupted, as Matplotlib's for fonts, crash when Python closes.
        os._exit(code)
    sys.exit(code if all(flushed) else code or 1)


def _show_unless_interrupt(
    kind: type[BaseException], error: BaseException, trace: TracebackType | None
) -> None:
    """Show an error, but no traceback of an interrupt that comes as the program ends."""
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)


def _raise_interrupt_again(fault: "sys.UnraisableHookArgs") -> None:
    """Raise an interrupt again that came where Python ignores exceptions, as while an object is deleted."""
    if not isinstance(fault.exc_value, KeyboardInterrupt):
        sys.__unraisablehook__(fault)
        return
    delay = 0.01
    while True:
        try:
            Timer(delay, interrupt_main).start()  # raised from here it would be ignored again
        except KeyboardInterrupt:  # the thread took longer to start
            delay *= 2
        else:
            return


def _run() -> int:
    if not _open_streams():
        _say("cannot write: standard output is closed; redirect it to a file, or to /dev/null")
        return 1
    if not ONE_THREAD.keys() & os.environ.keys():
        os.environ.update(ONE_THREAD)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="replace")  # type: ignore[union-attr] # a console that lacks ℓ still gets the numbers
    from fingerpad.cli import app

    try:
        app()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else int(end.code is not None)
    return 0


def _open_streams() -> bool:
    """Open the null device for standard streams that are closed, and return whether stdout was open.

    Otherwise the next files that are opened would take their numbers, and get what is written to them.
    """
    is_open = sys.stdout is not None
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115 (open to the end)
    return is_open


def _flushed(stream: TextIO) -> bool:
    """Write out what a stream still holds; drop what cannot be written, of which Python would complain."""
    try:
        stream.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        return False
    return True


def _say(message: str) -> None:
    with suppress(OSError):
        print(f"fingerpad: {message}", file=sys.stderr)


if __name__ == "__main__":
    main()
