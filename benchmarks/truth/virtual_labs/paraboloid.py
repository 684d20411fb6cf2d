"""A Hertzian paraboloid: nothing should print a thickness for it."""

import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

from .lab import write_curve

PROGRAM = str(Path(sys.executable).parent / "fingerpad")
RADIUS, REDUCED = 12.0, 60e-3 / (1 - 0.48**2)
# At a wedge angle of 0, 1/H = 2 / (palmar/distal² + palmar/across²) = 13.2 ± 1.0 mm.
STUDY = """
title = "Paraboloid"
poisson_ratio = 0.48
[uncertainty]
wedge_angle_deg_std = 0.1
roll_angle_deg_std = 0.1
load_relative_std = 0.01
[[fingers]]
name = "pad"
synthetic = true
semi_axes_mm = { palmar = 8.94, distal = 12.0, radial_ulnar = 10.0 }
semi_axes_mm_std = { palmar = 0.44, distal = 0.44, radial_ulnar = 0.44 }
[[curves]]
finger = "pad"
wedge_angle_deg = 0
synthetic = true
file = "curve.csv"
[[observations]]
name = "contact"
finger = "pad"
wedge_angle_deg = 0
synthetic = true
load_N = 0.664
ellipse_mm = { semi_major = 4.25, semi_minor = 4.23, std = 0.05, long_axis = "along" }
"""
A_THICKNESS = re.compile(r"[^.;]{0,60}\d mm thick|[Tt]hickness[^.;]{0,30} \d+(?:\.\d+)?[^.;]{0,40} mm")


def check_paraboloid(out: Path) -> list[str]:
    """Return what is said of thickness for A = πRξ, R = 12 mm, E = 60 kPa, in four realisations of noise."""
    lines = []
    for k in range(4):
        folder, rng = out / f"paraboloid{k}", np.random.default_rng([13, k])
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        travel = np.linspace(-0.4, 2.0, 240)
        xi = np.maximum(travel, 0)
        force, area = 4 / 3 * REDUCED * np.sqrt(RADIUS) * xi**1.5 + 0.01, np.pi * RADIUS * xi
        columns = travel + 0.4, force, travel + 0.4, area
        write_curve(folder / "curve.csv", columns, (0.005, 0.002, 0.8), rng)
        (folder / "study.toml").write_text(STUDY)
        run = [PROGRAM, "run", str(folder / "study.toml")]
        options = "--poisson-ratio 0.48 --semi-axes-mm 8.94 12.0 10.0 --pad-radius-mm-std 1"
        fit = [PROGRAM, "fit", str(folder / "curve.csv"), *options.split()]
        ran, fitted = (subprocess.run(x, capture_output=True, text=True, check=False) for x in (run, fit))
        if ran.returncode:
            lines.append(f"{k}: exit code {ran.returncode}: {ran.stdout} {ran.stderr}")
            continue
        summary = json.loads((folder / "results/summary.json").read_text())
        radius, layer = summary["summaries"][0], summary["curves"][0].get("layer") or {}
        report = re.sub(r"<[^>]*>|\s+", " ", (folder / "results/report.html").read_text())
        stated = {key: layer.get(key) for key in ("thickness_mm", "thickness_mm_ci95", "flags", "reasons")}
        key = "mean_curvature_radius_mm"
        lines += [
            f"{k}: 1/H = {radius[key]:.2f} ± {radius[f'{key}_std']:.2f} mm",
            f"   summary.json: {stated}",
            f"   report: {[m.group(0).strip() for m in A_THICKNESS.finditer(report)][:5]}",
            f"   printed by run: {[m.group(0) for m in A_THICKNESS.finditer(ran.stdout)]}",
            f"   printed by fit: {[x for x in fitted.stdout.splitlines() if 'layer' in x or 'thick' in x]}",
        ]
    return lines
