"""A lab: one finger, what is true of it, and the study that the lab writes."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from PIL import Image
from scipy import optimize

from benchmarks.arrays import Array
from benchmarks.truth.hertz import hertz_factors
from benchmarks.truth.true_image import equal_ellipse

from .physics import Gap, Law, Pad
from .pictures import FACES, Device, contact_image, outline_points, photograph

WEDGES = (30, 45)
METHODS = ("direct", "outline", "photograph")
KINDS = ("ellipsoid", "superelliptic", "ellipsoid", "dorsal", "ellipsoid")


@dataclass
class Truth:
    """What is true of a lab; by wedge angle (deg) or by name of the contact."""

    method: str
    pad: Pad
    youngs_modulus: float  # kPa
    thickness: float
    unstated_compliance: float
    mean_radius: dict[int, float] = field(default_factory=dict)
    corrected_radius: dict[int, float] = field(default_factory=dict)
    areas: dict[str, float] = field(default_factory=dict)
    axes: dict[str, tuple[float, float]] = field(default_factory=dict)
    indentation: dict[str, float] = field(default_factory=dict)
    # Of the curve at each angle: R_g and E_0g as their own equations have them, and the place of contact
    loading_radius: dict[int, float] = field(default_factory=dict)
    initial_modulus: dict[int, float] = field(default_factory=dict)
    contact_offset: dict[int, float] = field(default_factory=dict)


def make_lab(seed: int, folder: Path) -> Truth:
    """Write a lab's study into a folder and return what is true."""
    folder.mkdir(parents=True, exist_ok=True)
    lab = _Lab(seed, folder)
    lab.write_fingers()
    for wedge in WEDGES:
        lab.write_contacts(wedge)
        lab.write_curve(wedge)
    (folder / "study.toml").write_text("\n".join(lab.lines) + "\n")
    return lab.truth


class _Lab:
    """Draws what is true and what the lab knows, and collects the lines of its manifest."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.folder = folder
        self.rng = rng = np.random.default_rng([29, seed])
        bone, kind, method = bool(seed % 2), KINDS[(seed // 2) % 5], METHODS[(seed // 2) % 3]
        axes = rng.uniform(7, 9.5), rng.uniform(12, 16), rng.uniform(8.5, 12)
        other = {"dorsal_ratio": rng.uniform(0.7, 0.9)} if kind == "dorsal" else {}
        if kind == "superelliptic":
            other["exponent"] = float(rng.choice([rng.uniform(1.8, 1.93), rng.uniform(2.1, 2.4)]))
        pad = Pad(*axes, **other)
        self.stated_poisson, poisson_std = round(rng.uniform(0.46, 0.495), 3), 0.01
        poisson = float(np.clip(rng.normal(self.stated_poisson, poisson_std), 0.4, 0.4995))
        wedge_std, roll_std = (float(rng.choice([1.0, 2.0, 3.0])) for _ in range(2))
        self.load_std = round(rng.uniform(0.01, 0.03), 3)
        thickness = float(rng.uniform(4.5, 10)) if bone else np.inf
        self.gaps = {w: Gap(pad, w + rng.normal(0, wedge_std), rng.normal(0, roll_std)) for w in WEDGES}
        deepest = min(2.6, 0.42 * thickness)
        self.laws = {w: Law(gap, 1.15 * deepest, thickness, poisson) for w, gap in self.gaps.items()}
        # Loads stay within the laws; a finger too soft for 2 N is made stiffer.
        load_over_modulus = min(float(law.load(deepest)) for law in self.laws.values()) / (1 - poisson**2)
        drawn_modulus = float(np.exp(rng.uniform(np.log(30), np.log(100)))) / 1000
        youngs_modulus = max(drawn_modulus, 2.02 / load_over_modulus)
        self.reduced = youngs_modulus / (1 - poisson**2)
        highest = youngs_modulus * load_over_modulus
        self.loads = (0.5, 1, 2, 4) if highest > 4 else (0.5, 1, 2, 3) if highest > 3 else (0.5, 0.8, 1.3, 2)
        yields = rng.uniform(0.01, 0.05), rng.uniform(0.01, 0.05)
        self.compliance = float(rng.choice([0.0, 0.0, 0.0, *yields]))
        unstated = float(rng.uniform(0.005, 0.02)) if seed % 6 in {2, 5} and self.compliance == 0 else 0.0
        self.thickness_stated = bool(bone and rng.random() < 2 / 3)
        self.device = Device.draw(("sharp", "soft", "dirty")[int(rng.integers(3))], rng)
        scale_std = round(rng.uniform(0.002, 0.01), 4)
        self.mm_per_px = 25.4 / self.device.ppi * (1 + rng.normal(0, scale_std))
        self.gain = rng.normal(0, 0.8 * self.load_std)
        self.truth = Truth(method, pad, youngs_modulus * 1000, thickness, unstated)
        self.lines = [
            f'title = "Virtual lab {seed}"\npoisson_ratio = {self.stated_poisson}\n[uncertainty]',
            f"wedge_angle_deg_std = {wedge_std}\nroll_angle_deg_std = {roll_std}",
            f"load_relative_std = {self.load_std}\npoisson_ratio_std = {poisson_std}",
            f"[scales.device]\nppi = {self.device.ppi}\nrelative_std = {scale_std}",
        ]

    def write_fingers(self) -> None:
        """Write the finger as one method measures it, and without contacts as the others do."""
        for method in sorted(METHODS, key=lambda m: m == self.truth.method):
            name = "finger" if method == self.truth.method else f"finger_{method}"
            measured = {"direct": self._direct, "outline": self._outlines, "photograph": self._photographs}
            before, keys = measured[method]()
            self.lines.append(f'{before}[[fingers]]\nname = "{name}"\nsynthetic = true\n{keys}')
        if self.thickness_stated:
            stated = self.truth.thickness + self.rng.normal(0, 1.0)
            self.lines.append(f"effective_thickness_mm = {stated:.2f}\neffective_thickness_mm_std = 1.0")

    def _direct(self) -> tuple[str, str]:
        std, pad = round(self.rng.uniform(0.1, 0.3), 2), self.truth.pad
        axes = {"palmar": pad.palmar, "distal": pad.distal, "radial_ulnar": pad.radial_ulnar}
        measured = ", ".join(f"{k} = {v + self.rng.normal(0, std):.3f}" for k, v in axes.items())
        stds = ", ".join(f"{k} = {std}" for k in axes)
        return "", f"semi_axes_mm = {{ {measured} }}\nsemi_axes_mm_std = {{ {stds} }}"

    def _outlines(self) -> tuple[str, str]:
        noise, items = self.rng.uniform(0.03, 0.1), []
        for face in FACES:
            scale = 1 + self.rng.normal(0, 0.005)
            points = outline_points(self.truth.pad, face, noise, scale, self.rng)
            np.savetxt(self.folder / f"{face}.csv", points, "%.4f", ",", header="x_mm,y_mm", comments="")
            items.append(f'{{ face = "{face}", outline = "{face}.csv", outline_relative_std = 0.005 }}')
        return "", f"photographs = [{', '.join(items)}]"

    def _photographs(self) -> tuple[str, str]:
        mm_per_px, items = 0.05 * (1 + self.rng.normal(0, 0.005)), []
        for face in FACES:
            _save(photograph(self.truth.pad, face, mm_per_px, self.rng), self.folder / f"{face}.jpg")
            items.append(f'{{ face = "{face}", file = "{face}.jpg", scale = "camera", synthetic = true }}')
        scale = "[scales.camera]\nmm_per_px = 0.05\nrelative_std = 0.005\n"
        return scale, f"photographs = [{', '.join(items)}]"

    def write_contacts(self, wedge: int) -> None:
        """Render two contacts at each load."""
        truth, law, factors = self.truth, self.laws[wedge], []
        top = law.indentation(self.loads[-1] / self.reduced)
        for load in self.loads:
            for repeat in (1, 2):
                name = f"w{wedge}_{load}N_{repeat}"
                true_load = load / (1 + self.gain + self.rng.normal(0, 0.6 * self.load_std))
                xi = law.indentation(true_load / self.reduced)
                mean_pressures = [float(law.load(x)) / float(law.area(x)) for x in (xi, top)]
                pressure = min(mean_pressures[0] / mean_pressures[1], 1.1)
                contact = law.outline(xi), np.asarray(law.profile(np.sqrt(xi))), pressure
                picture, _ = contact_image(*contact, self.device, self.mm_per_px, rng=self.rng)
                _save(picture, self.folder / f"{name}.png")
                major, minor = equal_ellipse(contact[0])
                truth.areas[name], truth.axes[name] = np.pi * major * minor, (major, minor)
                truth.indentation[name] = xi
                factors.append(hertz_factors(minor / major)[1] ** -3)
                self.lines += [
                    f'[[observations]]\nname = "{name}"\nfinger = "finger"\nwedge_angle_deg = {wedge}',
                    f'load_N = {load}\nfile = "{name}.png"\nscale = "device"\nsynthetic = true',
                ]
        truth.mean_radius[wedge] = self.gaps[wedge].mean_curvature_radius()
        truth.corrected_radius[wedge] = truth.mean_radius[wedge] * float(np.mean(factors))

    def write_curve(self, wedge: int) -> None:
        """Write a loading curve, and keep what is true of it."""
        rng, law, truth = self.rng, self.laws[wedge], self.truth
        gain, load = self.gain + rng.normal(0, 0.6 * self.load_std), self.loads[-1]
        xi = np.linspace(0, law.indentation(load / self.reduced), 2000)
        compliance = self.compliance + truth.unstated_compliance
        speed, offset, loading = rng.uniform(0.5, 2), rng.uniform(0.2, 0.5), int(rng.integers(150, 250))
        travel = xi[-1] + compliance * load
        step, rows = travel / speed / loading, loading + 60
        displacement, time = offset + travel / loading * (np.arange(rows) - 60), np.arange(rows) * step
        seen = np.interp(displacement - offset, xi + compliance * self.reduced * law.load(xi), xi)
        force, area = self.reduced * law.load(seen), law.area(seen)
        noise = rng.uniform(0.003, 0.008), rng.uniform(0.001, 0.004), rng.uniform(0.4, 1.2)
        measured = (1 + gain) * force + rng.uniform(-0.05, 0.05) + rng.uniform(-0.01, 0.01) * time
        table = np.stack([time, measured, displacement, area], axis=1)
        for column, std in enumerate(noise, start=1):
            table[:, column] += rng.normal(0, std, len(table))
        table[area <= 0, 3] = 0  # no area is seen before contact
        name, header = f"curve_{wedge}.csv", "time_s,force_N,displacement_mm,area_mm2"
        np.savetxt(self.folder / name, table, "%.6g", ",", header=header, comments="")
        self.lines.append(f'[[curves]]\nfinger = "finger"\nwedge_angle_deg = {wedge}')
        self.lines.append(f'file = "{name}"\nsynthetic = true')
        if self.compliance:
            std = 0.1 * self.compliance
            found = max(self.compliance + rng.normal(0, std), 0.001)
            self.lines.append(f"stage_compliance_mm_per_N = {found:.5f}")
            self.lines.append(f"stage_compliance_mm_per_N_std = {std:.5f}")
        truth.contact_offset[wedge] = offset
        x, w, a = seen[seen > 0], force[seen > 0], area[seen > 0]
        radius = float((a * x).sum() / (np.pi * x**2).sum())
        hertz = 4 / 3 * np.sqrt(radius) * x**1.5 / (1 - self.stated_poisson**2)

        def residual(moduli: Array) -> Array:
            return hertz * moduli[0] / np.maximum(1 - hertz * moduli[1], 1e-3) - w

        fit = optimize.least_squares(residual, [w.max() / hertz.max(), 0.0])
        truth.loading_radius[wedge], truth.initial_modulus[wedge] = radius, float(fit.x[0]) * 1000


def _save(picture: Array, path: Path) -> None:
    Image.fromarray(np.round(picture).astype(np.uint8)).save(path, quality=93)
