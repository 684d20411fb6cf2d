# mypy: ignore-errors
# ruff: noqa
"""Records of a rigid flat plate on a soft adhesive sphere, written from the physics alone.

Units mm, N, MPa, s; work of adhesion in N/mm: 1 J/m2 = 1e-3 N/mm.

No closed JKR formula F(xi) / a(F) is used.  The chain is
 1. Boussinesq's point-load kernel integrated numerically (Ritz functions of the
    pressure) gives the elastic energy of a bonded disc, U_E(a, delta), and the
    coefficient of the edge singularity;
 2. total energy  V(a, delta; X) = U_E - w pi a^2 + k (X - delta)^2 / 2
    (k machine stiffness, X stage position);
 3. the contact line moves downhill in V to the nearest stationary point, row by
    row; snap-in and pull-off are the places where no neighbouring one exists.
Maugis-Dugdale records (kind "md") follow Maugis 1992, incl. the a = 0 stage.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

NU = 0.5


def reduced_modulus(E, nu=NU):
    """Plate rigid, sphere soft."""
    return E / (1.0 - nu * nu)


# ---------------------------------------------------------------- 1. elasticity
def _disp_of_pressure(r, p_of_r, n_phi=160, n_t=160):
    """Surface displacement (E* = 1, disc radius 1) at radius r < 1 under pressure
    p_of_r(rr, 1-rr^2): u = (1/pi) int int p ds dphi in polar coordinates about the
    field point, so that the 1/distance kernel cancels.
    """
    x, wx = np.polynomial.legendre.leggauss(n_phi)
    phi = 0.5 * np.pi * (x + 1.0)  # half circle, doubled
    wphi = 0.5 * np.pi * wx
    t, wt = np.polynomial.legendre.leggauss(n_t)
    th = 0.5 * np.pi * t  # chord: s = mid + half*sin(th)
    wth = 0.5 * np.pi * wt
    out = 0.0
    for ph, wp in zip(phi, wphi):
        mid = -r * np.cos(ph)
        half = np.sqrt(1.0 - (r * np.sin(ph)) ** 2)
        # whole chord (both directions of the ray): phi runs over half the circle
        q = (half * np.cos(th)) ** 2  # = 1 - rr^2 exactly
        out += wp * np.sum(wth * half * np.cos(th) * p_of_r(np.sqrt(1 - q), q))
    return out / np.pi


@functools.lru_cache(None)
def bonded_disc():
    """Coefficients of U_E = E*(c11 a d^2 - c12 a^3 d/R + c22 a^5/R^2) and of the edge
    stress -(s1 d - s2 a^2/R), from the pressure basis (1-r^2)^(-1/2, 1/2, 3/2).
    """
    powers = (-0.5, 0.5, 1.5)
    basis = [lambda r, q, m=m: q**m for m in powers]
    rr = np.linspace(0.02, 0.95, 24)
    M = np.array([[_disp_of_pressure(r, b) for b in basis] for r in rr])
    sol_flat = np.linalg.lstsq(M, np.ones_like(rr), rcond=None)[0]
    sol_par = np.linalg.lstsq(M, -0.5 * rr**2, rcond=None)[0]
    resid = max(np.abs(M @ sol_flat - 1).max(), np.abs(M @ sol_par + 0.5 * rr**2).max())
    x, wx = np.polynomial.legendre.leggauss(200)
    th = 0.25 * np.pi * (x + 1)
    wth = 0.25 * np.pi * wx  # r = sin(th)
    r, q, jac = np.sin(th), np.cos(th) ** 2, np.cos(th)

    def integral(sol, u):  # int p u 2 pi r dr
        p = sum(c * q**m for c, m in zip(sol, powers))
        return np.sum(wth * jac * 2 * np.pi * r * p * u)

    one, par = np.ones_like(r), -0.5 * r**2
    return dict(
        c11=0.5 * integral(sol_flat, one),
        c12=-0.5 * (integral(sol_flat, par) + integral(sol_par, one)),
        c22=0.5 * integral(sol_par, par),
        s1=sol_flat[0] * np.pi,
        s2=-sol_par[0] * np.pi,
        residual=resid,
    )


class Sphere:
    """Elastic bonded-disc energy of a parabolic sphere + spring (k=None: rigid)."""

    def __init__(self, R, E, k=None):
        self.R, self.Es, self.k = R, reduced_modulus(E), k
        b = bonded_disc()
        self.c = (b["c11"], b["c12"], b["c22"], b["s1"], b["s2"])

    def delta(self, a, X):
        c11, c12, *_ = self.c
        if self.k is None:
            return X + 0.0 * a
        return (self.k * X + self.Es * c12 * a**3 / self.R) / (self.k + 2 * self.Es * c11 * a)

    def force(self, a, d):  # dU_E/d delta
        return self.Es * (2 * self.c[0] * a * d - self.c[1] * a**3 / self.R)

    def release(self, a, d):
        """Signed energy release rate dU_E/d(pi a^2); negative sign where the edge is
        compressed (bodies would overlap outside, contact has to grow).
        """
        c11, c12, c22, s1, s2 = self.c
        g = (
            self.Es
            * (c11 * d**2 - 3 * c12 * a**2 * d / self.R + 5 * c22 * a**4 / self.R**2)
            / (2 * np.pi * a)
        )
        return np.where(s1 * d - s2 * a**2 / self.R <= 0, 1.0, -1.0) * np.abs(g)

    def relax(self, a0, X, w_adv, w_rec, a_big):
        """Downhill motion of the contact line at fixed X from radius a0."""
        if a0 <= 0:
            if X < 0:
                return 0.0
            a0 = 1e-7 * a_big
        G0 = float(self.release(a0, self.delta(a0, X)))
        if w_adv <= G0 <= w_rec:
            return a0
        if w_rec < G0:  # line retreats
            grid, w = a0 * np.linspace(1, 1e-4, 240), w_rec
            f = self.release(grid, self.delta(grid, X)) - w
            hit = np.nonzero(f <= 0)[0]
        else:  # line advances
            grid, w = np.linspace(a0, a_big, 240), w_adv
            f = self.release(grid, self.delta(grid, X)) - w
            hit = np.nonzero(f >= 0)[0]
        if hit.size == 0:
            return 0.0 if w_rec < G0 else a_big
        i = hit[0]
        fun = lambda a: float(self.release(a, self.delta(a, X))) - w
        return brentq(fun, grid[i - 1], grid[i], xtol=1e-13 * a_big, rtol=1e-12)

    def cycle(self, X, w_adv, w_rec=None):
        """Quasi-static history X -> (delta, F, a)."""
        w_rec = w_adv if w_rec is None else w_rec
        a_big = (
            4 * (np.sqrt(self.R * max(X.max(), 0)) + (9 * np.pi * w_rec * self.R**2 / self.Es) ** (1 / 3))
            + 1e-30
        )
        a, A = 0.0, np.empty_like(X)
        for i, x in enumerate(X):
            a = self.relax(a, x, w_adv, w_rec, a_big)
            A[i] = a
        on = A > 0
        d = np.where(on, self.delta(np.where(on, A, 1.0), X), X)
        F = np.where(on, self.force(A, d), 0.0)
        return d, F, A

    def cycle_rate(self, t, X, w0, v0, n):
        """Gent-Schultz line law: G = w0 (1 + (v/v0)^n) retreating; reversible advance."""
        d, F, A = self.cycle(X, w0)
        top = int(np.argmax(X))

        def rhs(tt, y):
            a = max(y[0], 1e-12)
            x = np.interp(tt, t, X)
            e = float(self.release(a, self.delta(a, x))) / w0 - 1
            return [-v0 * e ** (1 / n) if e > 0 else v0 * (-e) ** (1 / n)]

        a_stop = 0.02 * A[top]
        ev = lambda tt, y: y[0] - a_stop
        ev.terminal = True
        sol = solve_ivp(
            rhs,
            (t[top], t[-1]),
            [A[top]],
            method="LSODA",
            rtol=1e-7,
            atol=1e-9 * A[top],
            t_eval=t[top:],
            events=ev,
            max_step=(t[-1] - t[top]) / 200,
        )
        A = A.copy()
        A[top:] = 0
        A[top : top + sol.y.shape[1]] = sol.y[0]
        on = A > 0
        d = np.where(on, self.delta(np.where(on, A, 1.0), X), X)
        return d, np.where(on, self.force(A, d), 0.0), A


# ------------------------------------------------------------ Maugis-Dugdale
def maugis_curve(R, E, w, tabor, n=1500, a_top=6.0):
    """Equilibrium curve (delta, F, a), from large contact to c = 0.
    lambda = 1.157 Tabor; second part has a = 0 with a cohesive disc of radius c.
    """
    Es = reduced_modulus(E)
    K = 4 * Es / 3
    lam = 1.157 * tabor
    a_u, F_u = (np.pi * w * R**2 / K) ** (1 / 3), np.pi * w * R
    d_u = (np.pi**2 * w**2 * R / K**2) ** (1 / 3)

    def closure(m, a):
        s, th = np.sqrt(m * m - 1), np.arccos(1 / m)
        return 0.5 * lam * a * a * (s + (m * m - 2) * th) + 4 / 3 * lam**2 * a * (s * th - m + 1) - 1

    a = np.concatenate([np.linspace(a_top, 0.3, n), np.geomspace(0.3, 1e-3, n // 2)])
    m = np.empty_like(a)
    for i, ai in enumerate(a):
        hi = 2.0
        while closure(hi, ai) < 0:
            hi *= 2
        m[i] = brentq(closure, 1 + 1e-13, hi, args=(ai,), xtol=1e-14, rtol=1e-13)
    s, th = np.sqrt(m * m - 1), np.arccos(1 / m)
    F = (a**3 - lam * a**2 * (s + m * m * th)) * F_u
    d = (a**2 - 4 / 3 * a * lam * s) * d_u
    sig = 0.5 * lam * (np.pi * w * K * K / R) ** (1 / 3)
    ht = w / sig
    c = (m[-1] * a[-1] * a_u) * np.linspace(1, 0, n // 2)[1:]
    d0 = c**2 / (2 * R) - 4 * sig * c / (np.pi * Es) - ht
    F0 = -np.pi * sig * c**2
    return (np.r_[d, d0], np.r_[F, F0], np.r_[a * a_u, 0 * c], ht)


def follow_curve(X, d, F, a, k, ht):
    """Quasi-static walk on an equilibrium curve with spring k (None: rigid)."""
    Xc = d + (F / k if k is not None else 0.0)
    turn = np.nonzero(np.diff(Xc) > 0)[0]
    i_fold = turn[0] if turn.size else len(Xc) - 1
    # stable main branch: 0..i_fold (Xc falls).  Beyond: folds until Xc falls again
    main = slice(0, i_fold + 1)
    out = np.zeros((3, len(X)))
    on = False
    for i, x in enumerate(X):
        if not on and x >= -ht:
            on = True
        if on and x < Xc[i_fold]:
            on = False
        if on and (x >= Xc[i_fold]):
            xs = Xc[main][::-1]
            out[0, i] = np.interp(x, xs, d[main][::-1])
            out[1, i] = np.interp(x, xs, F[main][::-1])
            out[2, i] = np.interp(x, xs, a[main][::-1])
        else:
            out[:, i] = x, 0.0, 0.0
    return out


# ------------------------------------------------------------------- records
KINDS = (
    "pad", "pad_compliant", "afm", "afm_stage", "hertz", "hysteresis", "rate", "md", "truncated",
    "no_contact", "rough_noise",
)  # fmt: skip


def _stage(rng, n, x0, x1, x2, speed, dwell):
    """Constant sampling rate: from -x0 to x1 (mm), optional dwell, back to -x2."""
    T = np.array([0, (x0 + x1) / speed, dwell, (x1 + x2) / speed]).cumsum()
    t = np.linspace(0, T[-1], n)
    return t, np.interp(t, T, [-x0, x1, x1, -x2])


def records(
    seed: int,
    count: int,
    kind: str = "pad",
    noise: float | None = None,
    rows: int | None = None,
    tabor: float | None = None,
) -> Iterator[dict[str, Any]]:
    """Yield `count` dicts: time_s, displacement_mm, force_n (as measured), truth (plain
    numbers), clean (noise-free arrays).  noise: force noise / |pull-off| (else drawn).
    """
    if kind not in KINDS:
        raise ValueError(f"kind must be one of {KINDS}")
    for j in range(count):
        rng = np.random.default_rng([seed, j, KINDS.index(kind)])
        yield _record(rng, kind, noise, rows, tabor)


def _record(rng, kind, noise, rows, tabor):
    log = lambda lo, hi: float(np.exp(rng.uniform(np.log(lo), np.log(hi))))
    afm = kind.startswith("afm") or kind == "md"
    if afm:
        R, E, z0 = log(1e-3, 5e-2), log(1e-3, 0.5), 0.4e-6
        t_ad = rng.uniform(0.04, 0.16)  # a(zero load)/R
    else:
        R, E, z0 = log(2, 20), log(0.05, 2.0), 0.4e-6
        t_ad = None
    Es = reduced_modulus(E)
    if t_ad is None:
        w = log(3e-5, 5e-4)
        t_ad = min((9 * np.pi * w / (2 * Es * R)) ** (1 / 3), 0.16)
    w = 2 * Es * R * t_ad**3 / (9 * np.pi)  # only sizes the problem
    w_scale = w
    Fpo = 1.5 * np.pi * w * R  # scale only
    mu = (R * w**2 / (Es**2 * z0**3)) ** (1 / 3)
    if kind == "md":
        mu = float(tabor) if tabor is not None else float(rng.choice([0.1, 1.0, 5.0]))
        z0 = (R * w**2 / Es**2) ** (1 / 3) / mu
    if kind == "hertz":
        w = mu = 0.0
    w_rec = w * (rng.uniform(1.5, 6) if kind == "hysteresis" else 1.0)
    # depth: a few times the adhesive length, contact radius kept below 0.35 R
    d_u = R * t_ad**2
    depth = min(d_u * rng.uniform(1.0, 6.0), 0.10 * R)
    if kind == "no_contact":
        depth = -rng.uniform(0.2, 1.0) * d_u
    stiff = 2 * Es * R * t_ad  # contact stiffness scale
    k = None
    if kind in ("pad_compliant", "afm", "afm_stage"):
        k = stiff * log(0.05, 20)
    elif kind != "md" and rng.random() < 0.3:
        k = stiff * log(5, 100)
    stage_recorded = kind in ("pad_compliant", "afm_stage")
    if k is not None and kind != "no_contact":
        a_e = np.sqrt(R * depth)
        depth += (4 / 3 * Es * a_e**3 / R) / k  # stage travel for that indentation
    back = 3.2 * d_u * (w_rec / w_scale if w else 1) ** (2 / 3)
    if k is not None:
        back += 1.6 * Fpo * (w_rec / w_scale if w else 1) / k
    if kind == "rate":
        back *= 4
    pre = abs(depth) * rng.uniform(0.15, 0.8) if kind != "no_contact" else abs(depth) * 3
    if kind == "md":
        pre = max(pre, 2 * z0)
        back += 3 * z0
    if kind == "truncated":
        back = -0.35 * depth
    n = int(rows) if rows else int(round(log(200, 2000)))
    total = pre + 2 * depth + back
    speed = abs(total) / log(5, 200)
    dwell = float(rng.choice([0, 0, 0.1])) * abs(total) / speed if kind != "rate" else 0.0
    t, X = _stage(rng, n, pre, depth, back, speed, dwell)
    body = Sphere(R, E, k)
    v0 = nexp = 0.0
    if kind == "md":
        d, F, A = follow_curve(X, *maugis_curve(R, E, w, mu)[:3], k, maugis_curve(R, E, w, mu)[3])
    elif kind == "rate":
        nexp, v0 = float(rng.uniform(0.3, 0.7)), 0.0
        v0 = speed * R * t_ad / (2 * d_u) * log(0.1, 10)
        d, F, A = body.cycle_rate(t, X, w, v0, nexp)
    else:
        d, F, A = body.cycle(X, w, w_rec)
    # ---- as an instrument sees it
    scale = max(Fpo, 1e-30)
    peak = max(F.max(), Fpo)
    lev = noise if noise is not None else (log(0.15, 0.5) if kind == "rough_noise" else log(0.002, 0.05))
    sF = lev * scale
    sD = d_u * log(2e-4, 5e-3)
    off = rng.normal(0, 0.5) * scale
    drift = rng.normal(0, 0.15) * scale / t[-1]
    touch = rng.uniform(-1, 1) * 5 * abs(total)
    disp = (X if stage_recorded else d) + touch
    Fm = F + off + drift * t + rng.normal(0, sF, n)
    Dm = disp + rng.normal(0, sD, n)
    quant = 0.0
    if rng.random() < 0.4:  # AD converter, 14 bit of 3x peak
        quant = 6 * peak / 2**14
        Fm = np.round(Fm / quant) * quant
    if (w > 0 and kind not in ("no_contact", "truncated") and np.any(A == 0)) or kind == "md":
        i_po = int(np.argmin(F)) if kind != "hertz" else -1
        in_touch = np.nonzero(F != 0)[0]
        i_last = int(in_touch[-1]) if in_touch.size else -1
    else:
        i_po = i_last = -1
    truth = dict(
        radius_mm=R,
        modulus_mpa=E,
        poisson=NU,
        reduced_modulus_mpa=Es,
        work_n_per_mm=w,
        work_retract_n_per_mm=w_rec,
        tabor=mu,
        range_mm=z0,
        contact_displacement_mm=touch,
        machine_stiffness_n_per_mm=(float("inf") if k is None else k),
        machine_compliance_mm_per_n=(0.0 if k is None else 1.0 / k),
        displacement_is_stage=int(stage_recorded),
        force_offset_n=off,
        force_drift_n_per_s=drift,
        force_noise_n=sF,
        displacement_noise_mm=sD,
        force_step_n=quant,
        dwell_s=dwell,
        speed_mm_per_s=speed,
        line_speed_v0_mm_per_s=v0,
        line_exponent=nexp,
        peak_force_n=F.max(),
        peak_indentation_mm=d.max(),
        max_contact_radius_mm=A.max(),
        min_force_n=F.min(),
        index_of_min_force=i_po,
        index_of_last_contact=i_last,
        index_of_peak=int(np.argmax(X)),
        noise_over_pull_off=sF / scale,
        contact=int(A.max() > 0),
        pulled_off=int(i_last >= 0),
    )
    truth = {q: (int(v) if isinstance(v, (int, np.integer)) else float(v)) for q, v in truth.items()}
    return dict(
        kind=kind,
        time_s=t,
        displacement_mm=Dm,
        force_n=Fm,
        truth=truth,
        clean=dict(stage_mm=X, indentation_mm=d, force_n=F, contact_radius_mm=A),
    )
