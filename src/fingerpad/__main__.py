"""The command line, as ``fingerpad`` or ``python -m fingerpad``."""

import sys


def main() -> None:
    """Run the command line, or say what it needs."""
    try:
        from fingerpad.cli import app
    except ModuleNotFoundError as error:
        sys.exit(f"fingerpad's command line needs {error.name}: pip install 'fingerpad[study]'")
    app()


if __name__ == "__main__":
    main()
