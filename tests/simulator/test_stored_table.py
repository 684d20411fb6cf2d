"""The table of errors of the documentation, at two of its ten loads."""

import pytest
from benchmarks import RESULTS
from benchmarks.claims.simulators import PADS, TARGETS, rows_of


def stored(pad):
    """Return the errors of a pad in the stored table, by target."""
    text = (RESULTS / "simulators.md").read_text(encoding="utf-8")
    (line,) = (line for line in text.splitlines() if line.startswith(f"| {pad}:"))
    cells = [cell.strip() for cell in line.strip("|").split("|")]
    errors = {
        name: float(cell.removesuffix(" %")) / 100 for name, cell in zip(TARGETS, cells[1:], strict=False)
    }
    return errors, float(cells[5].removeprefix("× "))


def test_errors_of_the_soft_pad_are_those_that_are_stored() -> None:
    """Where load and indentation follow other powers, the worst errors are at the ends of the range."""
    errors, area = stored("soft, deep")
    rows = rows_of(PADS["soft, deep"], count=2)
    for name in ("Newton `kh`", "Drake"):
        assert rows[name].error == pytest.approx(errors[name], rel=0.02)
    for name in ("pressure by depth", "MuJoCo"):
        assert rows[name].error <= errors[name] + 5e-4
    assert rows["Newton `kh`"].area == pytest.approx(area, abs=0.02)
