"""Finite elements against the solver where both have the same layer, and against scikit-fem's assembly."""

import numpy as np
import pytest
from benchmarks.claims.finite_elements import assembled, exported_loads, rows_of

import fingerpad as fp
from fingerpad.simulator import elements_or_reason, export_finger, simulator_law
from fingerpad.simulator.elements import TissueElements, stiffness_of
from fingerpad.simulator.mesh import layer_mesh

PLACE = fp.Placement(fp.Ellipsoid(palmar=7.9, distal=13.8, radial_ulnar=11.8), wedge_angle=np.radians(30))


DEPTHS = (1.5, 2.2)


def test_elements_of_a_flat_wide_layer_have_the_load_of_the_solver() -> None:
    _, ratio = next(rows_of(fp.Tissue(0.05, 0.3, 8.0), DEPTHS, rings=8, layers=2))
    assert ratio == pytest.approx(1, abs=0.03)


def test_stiffness_is_that_of_scikit_fem() -> None:
    mesh = layer_mesh(PLACE, 6.0, rings=3, layers=2)
    other = assembled(mesh.points, mesh.tetrahedra, 0.4, order=2)
    own = stiffness_of(mesh, 0.4)
    apart = abs(own - other).max()
    assert apart < 0.02 * abs(own).max()
    rigid = np.tile([1.0, 2.0, 3.0], len(mesh.points))
    assert np.abs(own @ rigid).max() < 1e-12


def test_the_exported_file_has_the_load_that_is_stated(tmp_path, monkeypatch) -> None:
    """Read by meshio, assembled by scikit-fem; the mesh a coarser one, as that of the file takes a minute."""
    monkeypatch.setattr(
        "fingerpad.simulator.export.layer_mesh",
        lambda place, thickness: layer_mesh(place, thickness, rings=5, layers=3),
    )
    law = simulator_law(PLACE, fp.Tissue(0.05, 0.45, 8.0))
    export_finger(law, tmp_path, effective_mass=0.1)
    found = law.finite_elements()
    depth = 1000 * found.indentation[[0, 3, 5]]
    loads = exported_loads(tmp_path, tuple(depth), PLACE.normal)
    assert loads / law.pad.curve.load(depth) == pytest.approx(found.load_ratio[[0, 3, 5]], rel=0.01)
    words = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert f"{found.load_ratio[-1]:.2f} at the\n  highest" in words


def test_indentation_at_which_nothing_touches() -> None:
    mesh = layer_mesh(PLACE, 6.0, rings=3, layers=2)
    height = mesh.points @ PLACE.normal
    elements = TissueElements(
        mesh, stiffness_of(mesh, 0.4), normal=PLACE.normal, gap=height.max() - height, deepest=1.0
    )
    assert elements.load(1e-9) == 0


def test_no_elements_of_deep_and_of_thin_tissue_but_the_reason(tmp_path) -> None:
    deep = simulator_law(PLACE, fp.Tissue(0.06), (0.1, 1.0))
    export_finger(deep, tmp_path, effective_mass=0.1)
    assert "the law is that of deep tissue, without bone" in (tmp_path / "README.md").read_text(
        encoding="utf-8"
    )
    assert elements_or_reason(deep) == (None, "")
    with pytest.raises(fp.FingerpadError, match="thickness must be finite"):
        deep.finite_elements()
    elements, reason = elements_or_reason(simulator_law(PLACE, fp.Tissue(0.05, thickness=0.5)))
    assert elements is None
    assert "no finite elements: thickness must be finite and at least" in reason
