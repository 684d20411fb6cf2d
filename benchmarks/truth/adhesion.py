"""Records of a rigid flat plate on a soft adhesive sphere, written from the physics alone.

Units are mm, N, MPa and s; work of adhesion is in N/mm: 1 J/m² = 1e-3 N/mm. No closed JKR formula is used:

1. A bonded disc of radius a at depth δ has the pressures of a flat punch and of Hertz's paraboloid
   and so the elastic energy U = E* (a δ² − 2 a³ δ/(3R) + a⁵/(5R²)); its edge is pulled where δ < a²/R.
2. The total energy is V(a, δ; X) = U − w π a² + k (X − δ)²/2, with the machine's stiffness k and stage X.
3. The contact line moves downhill in V to the nearest stationary point, row by row. It snaps in and pulls off
   where there is no neighbouring one.

Records of Maugis and Dugdale's theory (kind "md") follow Maugis (1992), with the stage of a = 0.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from benchmarks.arrays import Array, Rng

POISSON = 0.5
KINDS = {
    "pad": "pads",
    "pad_compliant": "pads, displacement of a stage that yields",
    "afm": "spheres of a force microscope",
    "afm_stage": "the same, displacement of the stage",
    "hertz": "no adhesion",
    "hysteresis": "contact line pinned",
    "rate": "w grows with speed",
    "md": "Maugis–Dugdale",
    "truncated": "ends before pull-off",
    "no_contact": "never touches",
    "rough_noise": "noise 15 to 50 % of the pull-off",
}
_RANGE_MM = 0.4e-6  # of attraction


class Record(NamedTuple):
    """A record as an instrument takes it, and the truth."""

    time: Array
    displacement: Array
    force: Array
    radius: float
    modulus: float
    work_of_adhesion: float  # on the way out
    contact_offset: float
    compliance: float  # of the machine, mm/N
    is_stage: bool  # whether the displacement is that of the stage


def reduced_modulus(modulus: float) -> float:
    """Return E* of a soft sphere under a rigid plate."""
    return modulus / (1.0 - POISSON * POISSON)


class Sphere:
    """Elastic energy of a parabolic sphere's bonded disc, and a spring; rigid without a stiffness."""

    def __init__(self, radius: float, modulus: float, stiffness: float | None = None) -> None:
        self.R, self.Es, self.k = radius, reduced_modulus(modulus), stiffness

    def delta(self, a: Array | float, X: Array | float) -> Any:
        """Return δ at a contact radius and a place of the stage."""
        if self.k is None:
            return X + 0.0 * a
        return (self.k * X + self.Es * 2 / 3 * a**3 / self.R) / (self.k + 2 * self.Es * a)

    def force(self, a: Array, d: Array) -> Array:
        """Return dU/dδ."""
        return self.Es * (2 * a * d - 2 / 3 * a**3 / self.R)

    def release(self, a: Array | float, d: Array) -> Array:
        """Return the energy release rate dU/d(π a²), negative where the edge is compressed.

        Bodies would overlap outside of such an edge: the contact has to grow.
        """
        past = d - a**2 / self.R
        return np.where(past <= 0, 1.0, -1.0) * self.Es * past**2 / (2 * np.pi * a)

    def _relax(self, a0: float, X: float, works: tuple[float, float], largest: float) -> float:
        """Move the contact line downhill at a place of the stage, from radius a0."""
        if a0 <= 0:
            if X < 0:
                return 0.0
            a0 = 1e-7 * largest

        def rate(a: Array | float) -> Array:
            return self.release(a, self.delta(a, X))

        advancing, receding = works
        now = float(rate(a0))
        if advancing <= now <= receding:
            return a0
        if receding < now:
            grid, work = a0 * np.linspace(1, 1e-4, 240), receding
            passed = np.nonzero(rate(grid) - work <= 0)[0]
        else:
            grid, work = np.linspace(a0, largest, 240), advancing
            passed = np.nonzero(rate(grid) - work >= 0)[0]
        if passed.size == 0:
            return 0.0 if receding < now else largest
        ends = grid[passed[0] - 1], grid[passed[0]]
        found = brentq(lambda a: float(rate(a)) - work, *ends, xtol=1e-13 * largest, rtol=1e-12)
        return float(found)

    def _seen(self, X: Array, A: Array) -> tuple[Array, Array, Array]:
        on = A > 0
        d = np.where(on, self.delta(np.where(on, A, 1.0), X), X)
        return d, np.where(on, self.force(A, d), 0.0), A

    def cycle(self, X: Array, work: float, receding: float | None = None) -> tuple[Array, Array, Array]:
        """Return indentation, force and contact radius of a slow movement of the stage."""
        receding = work if receding is None else receding
        adhesive = (9 * np.pi * receding * self.R**2 / self.Es) ** (1 / 3)
        largest = 4 * (np.sqrt(self.R * max(X.max(), 0)) + adhesive) + 1e-30
        a, radii = 0.0, np.empty_like(X)
        for i, x in enumerate(X):
            radii[i] = a = self._relax(a, x, (work, receding), largest)
        return self._seen(X, radii)

    def cycle_rate(self, t: Array, X: Array, work: float, speed: float, n: float) -> tuple[Array, ...]:
        """Return the same where w grows on retreat as 1 + (v/v₀)ⁿ (Gent and Schultz)."""
        _, _, radii = self.cycle(X, work)
        top = int(np.argmax(X))

        def velocity(now: float, y: Array) -> list[float]:
            a = max(float(y[0]), 1e-12)
            excess = float(self.release(a, self.delta(a, float(np.interp(now, t, X))))) / work - 1
            return [-speed * excess ** (1 / n) if excess > 0 else speed * (-excess) ** (1 / n)]

        def stop(_: float, y: Array) -> float:
            return float(y[0] - 0.02 * radii[top])

        stop.terminal = True  # type: ignore[attr-defined]
        span, first = (t[top], t[-1]), radii[top]
        known = {"t_eval": t[top:], "events": stop, "max_step": (t[-1] - t[top]) / 200}
        found = solve_ivp(velocity, span, [first], method="LSODA", rtol=1e-7, atol=1e-9 * first, **known)
        out = radii.copy()
        out[top:] = 0
        out[top : top + found.y.shape[1]] = found.y[0]
        return self._seen(X, out)


def _maugis_curve(R: float, E: float, w: float, tabor: float, n: int = 1500) -> tuple[Array, Array, float]:
    """Return δ and F of the equilibrium from large contacts to none, and the range of attraction.

    λ is 1.157 times Tabor's parameter; the last part has a = 0 and a cohesive disc.
    """
    Es = reduced_modulus(E)
    K, lam = 4 * Es / 3, 1.157 * tabor

    def closure(m: float, a: float) -> float:
        s, angle = np.sqrt(m * m - 1), np.arccos(1 / m)
        cohesive = 0.5 * lam * a * a * (s + (m * m - 2) * angle)
        return float(cohesive + 4 / 3 * lam**2 * a * (s * angle - m + 1) - 1)

    a = np.concatenate([np.linspace(6.0, 0.3, n), np.geomspace(0.3, 1e-3, n // 2)])
    m = np.empty_like(a)
    for i, ai in enumerate(a):
        high = 2.0
        while closure(high, ai) < 0:
            high *= 2
        m[i] = brentq(closure, 1 + 1e-13, high, args=(ai,), xtol=1e-14, rtol=1e-13)
    s, angle = np.sqrt(m * m - 1), np.arccos(1 / m)
    force = (a**3 - lam * a**2 * (s + m * m * angle)) * (np.pi * w * R)
    depth = (a**2 - 4 / 3 * a * lam * s) * (np.pi**2 * w**2 * R / K**2) ** (1 / 3)
    stress = 0.5 * lam * (np.pi * w * K * K / R) ** (1 / 3)
    reach = w / stress
    disc = (m[-1] * a[-1] * (np.pi * w * R**2 / K) ** (1 / 3)) * np.linspace(1, 0, n // 2)[1:]
    last = disc**2 / (2 * R) - 4 * stress * disc / (np.pi * Es) - reach
    return np.r_[depth, last], np.r_[force, -np.pi * stress * disc**2], reach


def _follow(X: Array, d: Array, F: Array, k: float | None, reach: float) -> tuple[Array, Array]:
    """Return δ and F of a slow movement along an equilibrium curve, by a spring of stiffness k."""
    of_stage = d + (F / k if k is not None else 0.0)
    turns = np.nonzero(np.diff(of_stage) > 0)[0]
    fold = turns[0] if turns.size else len(of_stage) - 1
    stable = slice(fold, None, -1)
    depth, force, on = X.copy(), np.zeros_like(X), False
    for i, x in enumerate(X):
        on = (on or x >= -reach) and not x < of_stage[fold]
        if on:
            depth[i], force[i] = (np.interp(x, of_stage[stable], one[stable]) for one in (d, F))
    return depth, force


def records(seed: int, count: int, kind: str) -> Iterator[Record]:
    """Yield `count` records of a kind."""
    for number in range(count):
        rng = np.random.default_rng([seed, number, [*KINDS].index(kind)])
        yield _record(rng, kind)


def _record(rng: Rng, kind: str) -> Record:  # noqa: PLR0912, PLR0915 (one number drawn after another)
    def log(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    if kind.startswith("afm") or kind == "md":
        R, E = log(1e-3, 5e-2), log(1e-3, 0.5)
        Es = reduced_modulus(E)
        relative = rng.uniform(0.04, 0.16)  # contact radius at no load over R
    else:
        R, E = log(2, 20), log(0.05, 2.0)
        Es = reduced_modulus(E)
        relative = min((9 * np.pi * log(3e-5, 5e-4) / (2 * Es * R)) ** (1 / 3), 0.16)
    size = 2 * Es * R * relative**3 / (9 * np.pi)  # work of adhesion, from which all else is sized
    pull_off, w = 1.5 * np.pi * size * R, 0.0 if kind == "hertz" else size
    reach, tabor = _RANGE_MM, 0.0
    if kind == "md":
        tabor = float(rng.choice([0.1, 1.0, 5.0]))
        reach = (R * w**2 / Es**2) ** (1 / 3) / tabor
    receding = w * (rng.uniform(1.5, 6) if kind == "hysteresis" else 1.0)
    # a few times the adhesive length; the contact radius stays below 0.35 R
    unit = R * relative**2
    depth = min(unit * rng.uniform(1.0, 6.0), 0.10 * R)
    if kind == "no_contact":
        depth = -rng.uniform(0.2, 1.0) * unit
    stiffness, k = 2 * Es * R * relative, None
    if kind in {"pad_compliant", "afm", "afm_stage"}:
        k = stiffness * log(0.05, 20)
    elif kind != "md" and rng.random() < 0.3:
        k = stiffness * log(5, 100)
    if k is not None and kind != "no_contact":
        depth += (4 / 3 * Es * np.sqrt(R * depth) ** 3 / R) / k  # travel of the stage for that indentation
    ratio = receding / size if w else 1
    back = 3.2 * unit * ratio ** (2 / 3)
    if k is not None:
        back += 1.6 * pull_off * ratio / k
    if kind == "rate":
        back *= 4
    before = abs(depth) * rng.uniform(0.15, 0.8) if kind != "no_contact" else abs(depth) * 3
    if kind == "md":
        before, back = max(before, 2 * reach), back + 3 * reach
    if kind == "truncated":
        back = -0.35 * depth
    rows, travel = round(log(200, 2000)), before + 2 * depth + back
    speed = abs(travel) / log(5, 200)
    dwell = float(rng.choice([0, 0, 0.1])) * abs(travel) / speed if kind != "rate" else 0.0
    corners = np.array([0, (before + depth) / speed, dwell, (depth + back) / speed]).cumsum()
    t = np.linspace(0, corners[-1], rows)
    X = np.interp(t, corners, [-before, depth, depth, -back])
    body = Sphere(R, E, k)
    if kind == "md":
        of_depth, of_force, cohesive = _maugis_curve(R, E, w, tabor)
        d, F = _follow(X, of_depth, of_force, k, cohesive)
    elif kind == "rate":
        power = float(rng.uniform(0.3, 0.7))
        d, F, _ = body.cycle_rate(t, X, w, speed * R * relative / (2 * unit) * log(0.1, 10), power)
    else:
        d, F, _ = body.cycle(X, w, receding)
    # As an instrument sees it
    scale, peak = max(pull_off, 1e-30), max(F.max(), pull_off)
    force_std = (log(0.15, 0.5) if kind == "rough_noise" else log(0.002, 0.05)) * scale
    displacement_std = unit * log(2e-4, 5e-3)
    zero, drift = rng.normal(0, 0.5) * scale, rng.normal(0, 0.15) * scale / t[-1]
    offset = rng.uniform(-1, 1) * 5 * abs(travel)
    is_stage = kind in {"pad_compliant", "afm_stage"}
    force = F + zero + drift * t + rng.normal(0, force_std, rows)
    displacement = (X if is_stage else d) + offset + rng.normal(0, displacement_std, rows)
    if rng.random() < 0.4:  # a converter of 14 bits over three times the peak
        step = 6 * peak / 2**14
        force = np.round(force / step) * step
    return Record(t, displacement, force, R, E, receding, offset, 0.0 if k is None else 1.0 / k, is_stage)
