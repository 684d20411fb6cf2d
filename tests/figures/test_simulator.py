"""The law over a loading curve: what is drawn, and the numbers behind it."""

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.figures import new_panels, plot_simulated_load
from fingerpad.figures.marks import Band, Line, Points
from fingerpad.figures.publish import figure_csv
from fingerpad.simulator import simulator_law

PLACE = fp.Placement(fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))


def test_law_targets_and_points() -> None:
    law = simulator_law(PLACE, fp.Tissue(0.05, thickness=8.0), stds={"youngs_modulus": 0.005})
    figure, (panel,) = new_panels()
    plot_simulated_load(
        panel,
        law.indentation,
        law.load,
        load_std=law.load_std,
        simulated=law.simulated_loads(),
        measured=([0.5, 1.0], [0.2, 0.7]),
    )
    kinds = [type(mark) for mark in panel.marks]
    assert kinds == [Points, Band, Line, Line, Line, Line]
    assert [mark.label for mark in panel.marks[2:]] == ["law of the pad", "Newton kh", "Drake", "MuJoCo"]
    assert "measured,0.5,0.2" in figure_csv(figure)


@pytest.mark.parametrize("name", ["Newton kh", "Drake", "MuJoCo"])
def test_simulated_loads_are_as_far_off_as_their_targets_say(name) -> None:
    law = simulator_law(PLACE, fp.Tissue(0.05, thickness=8.0))
    target = {"Newton kh": law.newton_kh(), "Drake": law.drake_modulus(), "MuJoCo": law.mujoco(0.1)}[name]
    error = np.abs(law.simulated_loads()[name] / law.load - 1).max()
    assert error == pytest.approx(target.worst_relative_error, rel=0.02)
    paraboloid = simulator_law(fp.Paraboloid(12.0, 14.0), fp.Tissue(0.05, thickness=8.0), (0.2, 2.0))
    assert "Drake" not in paraboloid.simulated_loads()
