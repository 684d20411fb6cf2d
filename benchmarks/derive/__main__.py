"""Fit one calibrated model again, or list those there are."""

import argparse
import importlib

from benchmarks.derive.fit import names, show

if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m benchmarks.derive", description="Fit constants again.")
    parser.add_argument("name", nargs="?", choices=names(), help="what to fit; without it, what there is")
    parser.add_argument("--images", type=int, default=3, help="of each condition (3)")
    # No table of claims is of these seeds: what is fitted to its images would make it too good.
    parser.add_argument(
        "--seeds", type=int, nargs=2, default=(101, 102), metavar=("FIT", "OTHER"), help="(101 102)"
    )
    given = parser.parse_args()
    if given.name is None:
        for name in names():
            module = importlib.import_module(f"benchmarks.derive.{name}")
            print(f"{name:<12} {(module.__doc__ or '').splitlines()[0]}")
    else:
        module = importlib.import_module(f"benchmarks.derive.{given.name}")
        if hasattr(module, "PROBLEMS"):
            for problem in module.PROBLEMS:
                show(problem, given.images, *given.seeds)
        else:
            module.show(given.images, *given.seeds)
