# ruff: noqa
# mypy: ignore-errors
"""Independent truth: pictures of smooth (ridge-free) contacts, from gap + optics.

Contact = ellipse (semi-axes a >= b) where the gap is exactly zero.  Gap outside:
   Hertz      h = C  int_0^lam (x^2/(a^2+s) + y^2/(b^2+s) - 1) ds / sqrt(s(a^2+s)(b^2+s))
   + adhesive h += D int_0^lam ds / sqrt(s (a^2+s)(b^2+s)) / int_0^inf   (flat punch, JKR-like)
lam: the ellipsoidal coordinate of the point.  Pixel values near the edge are averaged over
6 x 6 sub-pixels; then lens blur, illumination, dirt, reflections, noise, 8 bit, maybe JPEG.
Angle: degrees from the +column axis towards +row (clockwise as displayed), in (-90, 90].
"""

from __future__ import annotations
import numpy as np
import cv2
from scipy.integrate import quad

KINDS = ("ftir", "ftir_dark", "gelsight", "wet", "newton", "none", "cut")
_T, _W = np.polynomial.legendre.leggauss(14)


# ------------------------------------------------------------------- geometry
class Gap:
    def __init__(self, a, b, R, stretch):
        self.a, self.b, self.R, self.stretch = a, b, R, stretch
        # C from the curvature 1/(2R) along the major axis (Hertz ellipse potential), s = t^2
        k = lambda f: quad(f, 0, np.inf)[0]
        self.ka = k(lambda t: 2 / ((a * a + t * t) ** 1.5 * (b * b + t * t) ** 0.5))
        self.kb = k(lambda t: 2 / ((a * a + t * t) ** 0.5 * (b * b + t * t) ** 1.5))
        self.k0 = k(lambda t: 2 / ((a * a + t * t) ** 0.5 * (b * b + t * t) ** 0.5))
        self.C = 1 / (2 * R * self.ka)
        self.D = stretch / self.k0

    def lam(self, x, y):
        a2, b2 = self.a**2, self.b**2
        B = a2 + b2 - x * x - y * y
        q = a2 * b2 - x * x * b2 - y * y * a2
        root = np.sqrt(np.maximum(B * B - 4 * q, 0))
        with np.errstate(divide="ignore", invalid="ignore"):
            l = np.where(B > 0, -2 * q / (B + root), 0.5 * (root - B))
        return np.maximum(np.nan_to_num(l), 0.0)

    def __call__(self, x, y):
        """Gap in mm at points in the ellipse frame (x major)."""
        lam = self.lam(x, y)
        T = np.sqrt(lam)
        h = np.zeros_like(lam)
        p = np.zeros_like(lam)
        x2, y2, a2, b2 = x * x, y * y, self.a**2, self.b**2
        for g, w in zip(_T, _W):
            s = (0.5 * T * (g + 1)) ** 2
            A, Bq = a2 + s, b2 + s
            d = w * T / np.sqrt(A * Bq)  # = 2 * (T/2) w / sqrt
            h += d * (x2 / A + y2 / Bq - 1)
            p += d
        return np.maximum(self.C * h + self.D * p, 0.0)

    def surface(self, x, y):
        """Indented elastic surface (Hertz), depth below the far surface, mm."""
        l0 = self.lam(x, y)
        T0 = np.arctan2(np.sqrt(l0), self.a)  # t = a tan(T)
        out = np.zeros_like(l0)
        x2, y2, a2, b2 = x * x, y * y, self.a**2, self.b**2
        half = 0.5 * (np.pi / 2 - T0)
        for g, w in zip(_T, _W):
            th = T0 + half * (g + 1)
            s = (self.a * np.tan(th)) ** 2
            A, Bq = a2 + s, b2 + s
            out += w * half * 2 * (1 - x2 / A - y2 / Bq) / np.sqrt(A * Bq) * self.a / np.cos(th) ** 2
        return self.C * out

    def punch(self, x, y):
        """Surface around a flat elliptical punch of unit depth."""
        T = np.sqrt(self.lam(x, y))
        p = np.zeros_like(T)
        for g, w in zip(_T, _W):
            s = (0.5 * T * (g + 1)) ** 2
            p += w * T / np.sqrt((self.a**2 + s) * (self.b**2 + s))
        return 1 - p / self.k0


def _frame(shape, centre, ang, mm, rows=None, cols=None):
    if rows is None:
        rows, cols = np.mgrid[0 : shape[0], 0 : shape[1]].astype(np.float64)
    y, x = (rows - centre[0]) * mm, (cols - centre[1]) * mm
    c, s = np.cos(np.deg2rad(ang)), np.sin(np.deg2rad(ang))
    return c * x + s * y, -s * x + c * y


def _render(signal, gap, shape, centre, ang, mm, band_px=3.0, sub=6):
    """signal(h, inside) averaged over pixels; sub-pixel grid only near the edge."""
    x, y = _frame(shape, centre, ang, mm)
    h = gap(x, y)
    out = signal(h)
    rho = np.sqrt((x / gap.a) ** 2 + (y / gap.b) ** 2)
    near = np.abs(rho - 1) * gap.b < band_px * mm
    r, c = np.nonzero(near)
    acc = np.zeros((len(r),) + out.shape[2:])
    for i in range(sub):
        for j in range(sub):
            xs, ys = _frame(shape, centre, ang, mm, r + (i + 0.5) / sub - 0.5, c + (j + 0.5) / sub - 0.5)
            acc += signal(gap(xs, ys))
    out[r, c] = acc / sub**2
    return out, h


def _apparent(gap, depth):
    """Where exp(-h/depth) = 1/2, mm beyond the true edge on the major and minor axes."""
    out = []
    for ax in (0, 1):
        e = (gap.a, gap.b)[ax]
        t = e * (1 + np.linspace(0, 0.6, 40001) ** 2)
        z = np.zeros_like(t)
        hh = gap(t, z) if ax == 0 else gap(z, t)
        out.append(float(np.interp(depth * np.log(2), hh, t) - e))
    return out


# ------------------------------------------------------------------- dressing
def _smooth_noise(rng, shape, size, octaves=1):
    out = np.zeros(shape, np.float32)
    for o in range(octaves):
        s = max(int(round(size / 2**o)), 1)
        g = rng.normal(0, 1, (int(shape[0] / s) + 3, int(shape[1] / s) + 3)).astype(np.float32)
        g = cv2.resize(g, None, fx=s, fy=s, interpolation=cv2.INTER_LINEAR)[: shape[0], : shape[1]]
        out += cv2.GaussianBlur(g, (0, 0), max(0.45 * s, 0.4)) / 2**o
    return out / max(out.std(), 1e-9)


def _light(rng, shape, strength=0.5):
    """Illumination field, mean about 1: gradient, hot spot, vignetting."""
    r, c = np.mgrid[-1 : 1 : shape[0] * 1j, -1 : 1 : shape[1] * 1j]
    th = rng.uniform(0, 2 * np.pi)
    g = 1 + strength * rng.uniform(0.3, 1) * (np.cos(th) * c + np.sin(th) * r) / 1.4
    g *= 1 + strength * rng.uniform(-0.2, 0.8) * np.exp(
        -((r - rng.uniform(-1, 1)) ** 2 + (c - rng.uniform(-1, 1)) ** 2) / rng.uniform(0.4, 2)
    )
    asp = shape[0] / shape[1]
    g *= (1 + rng.uniform(0.05, 0.45) * strength * (c * c + (r * asp) ** 2)) ** -2
    return np.maximum(g / g.mean(), 0.08)


def _guide(rng, shape):
    """Edge-lit light guide: decays from lit sides, scalloped by single LEDs."""
    r, c = np.mgrid[0 : 1 : shape[0] * 1j, 0 : 1 : shape[1] * 1j]
    out = np.zeros(shape)
    sides = rng.permutation(4)[: rng.integers(1, 5)]
    for s in sides:
        d, t = ((r, c), (1 - r, c), (c, r), (1 - c, r))[s]
        L = rng.uniform(0.4, 1.6)
        led = 1 + rng.uniform(0, 0.3) * np.exp(-d / 0.12) * np.cos(
            2 * np.pi * rng.integers(4, 9) * t + rng.uniform(0, 6)
        )
        out += rng.uniform(0.6, 1) * np.exp(-d / L) * led
    return out / out.mean()


def _specks(rng, shape, n, rmax):
    """Dust and lint coverage 0..1 in focus or not."""
    out = np.zeros(shape, np.float32)
    for _ in range(n):
        q = np.zeros(shape, np.float32)
        p = (int(rng.integers(0, shape[1]) * 16), int(rng.integers(0, shape[0]) * 16))
        if rng.random() < 0.8:
            rad = rmax * rng.uniform(0.15, 1) ** 2
            ax = (max(int(16 * rad), 6), max(int(16 * rad * rng.uniform(0.4, 1)), 5))
            pts = cv2.ellipse2Poly((0, 0), ax, int(rng.integers(0, 180)), 0, 360, 20)
            pts = pts * rng.uniform(0.75, 1.2, (len(pts), 1)) + p
            cv2.fillPoly(q, [pts.astype(np.int32)], 1.0, cv2.LINE_AA, 4)
        else:  # lint
            k = np.cumsum(np.cumsum(rng.normal(0, 0.25, 24)))
            st = rmax * rng.uniform(0.3, 1.1)
            pts = np.cumsum(np.c_[np.cos(0.3 * k), np.sin(0.3 * k)], 0) * st * 16 + p
            cv2.polylines(q, [pts.astype(np.int32)], False, 1.0, 1, cv2.LINE_AA, 4)
        out = np.maximum(out, q * rng.uniform(0.3, 1))
    return cv2.GaussianBlur(out, (0, 0), rng.uniform(0.5, 1.3))


def _scratches(rng, shape, n):
    out = np.zeros(shape, np.float32)
    for _ in range(n):
        p = rng.uniform(0, 1, 2) * shape[::-1]
        th, L = rng.uniform(0, np.pi), rng.uniform(0.05, 0.5) * max(shape)
        t = np.linspace(-1, 1, 20)[:, None]
        pts = p + t * L / 2 * [np.cos(th), np.sin(th)] + t**2 * rng.normal(0, 4, 2)
        q = np.zeros(shape, np.float32)
        cv2.polylines(q, [(pts * 16).astype(np.int32)], False, 1.0, 1, cv2.LINE_AA, 4)
        out = np.maximum(out, q * rng.uniform(0.15, 0.8))
    return cv2.GaussianBlur(out, (0, 0), 0.7)


def _reflection(rng, shape, near=None, kind=None):
    """Lamp image / window streak / ring light, 0..1, soft."""
    r, c = np.mgrid[0 : shape[0], 0 : shape[1]].astype(float)
    if near is None:
        near = rng.uniform(0.1, 0.9, 2) * shape
    kind = kind or rng.choice(["spot", "streak", "window"])
    th = rng.uniform(0, np.pi)
    x = (c - near[1]) * np.cos(th) + (r - near[0]) * np.sin(th)
    y = -(c - near[1]) * np.sin(th) + (r - near[0]) * np.cos(th)
    m = min(shape)
    if kind == "spot":
        s = m * rng.uniform(0.015, 0.05)
        d = np.sqrt((x / s) ** 2 + (y / s / rng.uniform(0.6, 1)) ** 2)
        out = 1 / (1 + np.exp(np.minimum((d - 1) * rng.uniform(4, 12), 60))) + 0.18 * np.exp(-d / 2.5)
    elif kind == "streak":
        s, L = m * rng.uniform(0.008, 0.03), m * rng.uniform(0.15, 0.6)
        y = y + rng.normal(0, 0.15) * x**2 / L
        out = np.exp(-(np.abs(y / s) ** 2)) * np.exp(-(np.abs(x / L) ** 4))
    else:
        s = m * rng.uniform(0.04, 0.1)
        q = np.maximum(np.abs(x + 0.2 * y) / s, np.abs(y) / s / rng.uniform(0.5, 1.2))
        out = 1 / (1 + np.exp(np.minimum((q - 1) * 14, 60)))
        out *= 1 - 0.6 * np.exp(-((x / s / 0.07) ** 2))
    return out


class Look:
    """What belongs to one set-up: camera, light, dirt.  expose() makes the 8-bit pictures."""

    def __init__(self, rng, shape):
        self.rng, self.shape = rng, shape
        self.psf = rng.uniform(0.6, 1.6)
        self.full = np.exp(rng.uniform(np.log(1500), np.log(20000)))  # electrons at 255
        self.read = rng.uniform(0.3, 2.0)
        self.gamma = float(rng.choice([1.0, 1.0, 0.8, 0.6]))
        self.jpeg = int(rng.integers(65, 96)) if rng.random() < 0.35 else 0

    def expose(self, lin):
        """lin: linear light 0..1, HxW or HxWx3."""
        rng = self.rng
        v = cv2.GaussianBlur(lin.astype(np.float32), (0, 0), self.psf)
        v = np.clip(v, 0, None) * 255
        v = v + rng.normal(0, 1, v.shape) * np.sqrt(v * 255 / self.full + self.read**2)
        v = 255 * (np.clip(v, 0, 255) / 255) ** self.gamma
        v = np.clip(np.round(v), 0, 255).astype(np.uint8)
        if self.jpeg:
            q = v[..., ::-1] if v.ndim == 3 else v
            v = cv2.imdecode(
                cv2.imencode(".jpg", q, [cv2.IMWRITE_JPEG_QUALITY, self.jpeg])[1],
                cv2.IMREAD_COLOR if v.ndim == 3 else cv2.IMREAD_GRAYSCALE,
            )
            v = np.ascontiguousarray(v[..., ::-1]) if v.ndim == 3 else v
        return v


TINTS = {
    "white": (1, 0.98, 0.94),
    "green": (0.12, 1, 0.3),
    "blue": (0.12, 0.4, 1),
    "red": (1, 0.22, 0.15),
    "warm": (1, 0.85, 0.6),
}


def _tint(x, rgb):
    return x[..., None] * np.asarray(rgb) if rgb is not None else x


# ------------------------------------------------------------------- scenes
def _edge_point(rng, a, b, ang, mm, centre):
    t = rng.uniform(0, 2 * np.pi)
    x, y = a * np.cos(t) / mm, b * np.sin(t) / mm
    c, s = np.cos(np.deg2rad(ang)), np.sin(np.deg2rad(ang))
    return np.array([centre[0] + s * x + c * y, centre[1] + c * x - s * y])


def _scene(rng, kind, cut=False, contact=True, want=None, grown=1.0, noise=None):
    """A picture; `grown` is the contact's size in parts of that drawn, `noise` the camera's own rng."""
    big = rng.random() < 0.35
    H = int(rng.integers(300, 700) if not big else rng.integers(700, 1201))
    Wd = int(np.clip(H * rng.choice([1, 1, 4 / 3, 4 / 3, 16 / 9]), 300, 1600))
    shape = (H, Wd)
    lo, hi = (0.01, 0.03) if kind == "newton" else (0.01, 0.08)
    mm = float(np.exp(rng.uniform(np.log(lo), np.log(hi))))
    a_px = rng.uniform(max(45, 0.12 * H), 0.38 * H)
    if a_px * mm > 12:
        mm = 12 / a_px
    ratio = float(rng.choice([1.0, rng.uniform(0.6, 1), rng.uniform(0.8, 1)]))
    a = a_px * mm
    b = a * ratio
    ang = float(rng.uniform(-90, 90)) if ratio < 1 else 0.0
    if cut:
        side = rng.integers(0, 4)
        off = a_px * rng.uniform(-0.4, 0.75)
        centre = [rng.uniform(0.3, 0.7) * H, rng.uniform(0.3, 0.7) * Wd]
        centre[0 if side < 2 else 1] = off if side % 2 == 0 else (H, Wd)[0 if side < 2 else 1] - off
    else:
        m = a_px * 1.06 + 4
        centre = [rng.uniform(m, H - m), rng.uniform(m, Wd - m)]
    R = a * rng.uniform(2.8, 8)
    if kind == "newton":  # weak lens: first dark ring 3-25 px beyond the edge
        R = a * a * 1.2 * (np.exp(rng.uniform(np.log(3), np.log(25))) * mm / a) ** 1.5 / 0.27e-3
    stretch = 0.0
    if rng.random() < 0.5 and kind != "newton":  # JKR: sqrt(2 pi a w/E*)
        stretch = np.sqrt(2 * np.pi * np.sqrt(a * b) * np.exp(rng.uniform(np.log(1e-5), np.log(4e-4))))
        stretch = min(stretch, 0.15 * a * a / R)
    # Hertz: the radius of curvature stays while the contact grows.  JKR: the stretch goes with the root.
    gap = Gap(a * grown, b * grown, R, min(stretch * grown**0.5, 0.15 * (a * grown) ** 2 / R))
    look = Look(rng, shape)
    dist = []
    illum = _light(rng, shape, rng.uniform(0.15, 1))
    dust = _specks(rng, shape, int(rng.integers(0, 26)), rng.uniform(1.5, 5) * H / 500)
    if dust.max() > 0.2:
        dist.append("dust")
    scr = _scratches(rng, shape, int(rng.choice([0, 0, 2, 6])))
    if scr.max() > 0.1:
        dist.append("scratches")
    refl_glass = np.zeros(shape)
    for _ in range(int(rng.choice([0, 0, 1, 2]))):
        near = _edge_point(rng, a, b, ang, mm, centre) if rng.random() < 0.6 else None
        refl_glass += rng.uniform(0.15, 0.9) * _reflection(rng, shape, near)
        dist.append("reflection_over_edge" if near is not None else "reflection")
    refl_body = np.zeros(shape)  # on the finger itself, not in background
    if rng.random() < 0.3 and kind not in ("gelsight", "newton"):
        p = _edge_point(rng, a * rng.uniform(1.05, 1.35), b * rng.uniform(1.05, 1.35), ang, mm, centre)
        refl_body = rng.uniform(0.1, 0.4) * _reflection(rng, shape, p, "spot")
        dist.append("highlight_on_finger")
    drift = rng.uniform(0.97, 1.03)
    rgb = None if rng.random() < 0.5 else TINTS[str(rng.choice(list(TINTS)))]
    extra = {}
    S = lambda sig, band=3.0: (
        _render(sig, gap, shape, centre, ang, mm, band)
        if contact
        else (sig(np.full(shape, 50.0)), np.full(shape, 50.0))
    )
    x, y = _frame(shape, centre, ang, mm)
    # the pad behind the glass: visible through room light when the gap is small
    lift = a * a / R * rng.uniform(0.1, 0.7) if not contact else 0.0  # hovering height, mm
    hfar = np.maximum((x / gap.a) ** 2 + (y / gap.b) ** 2 - 1, 0) * gap.a**2 / (2 * R) + lift
    hover = contact or want == "hover"

    if kind in ("ftir", "ftir_dark"):
        lam, n, th = 1e-6 * rng.uniform(480, 850), 1.5, np.deg2rad(rng.uniform(46, 75))
        depth = lam / (4 * np.pi * np.sqrt((n * np.sin(th)) ** 2 - 1))  # mm, intensity 1/e
        T, h = S(lambda g: np.exp(-g / depth))
        extra.update(penetration_depth_mm=depth)
        if contact:
            extra["apparent_beyond_major_mm"], extra["apparent_beyond_minor_mm"] = _apparent(gap, depth)
        mott = 1 + rng.uniform(0.0, 0.07) * _smooth_noise(rng, shape, rng.uniform(4, 30), 3)
        # a few spots where dust on the finger keeps the surfaces apart
        hole = _specks(rng, shape, int(rng.integers(0, 7)), rng.uniform(2, 6) * H / 500) if contact else 0
        T = T * (1 - 0.9 * hole) * np.clip(mott, 0.3, 1.5)
        blurf = cv2.GaussianBlur(
            np.exp(-hfar / (a * a / R * rng.uniform(0.2, 0.8))).astype(np.float32), (0, 0), H * 0.006
        )
        halo = rng.uniform(0.01, 0.14) * blurf if hover else 0
        if kind == "ftir":
            guide = _guide(rng, shape)
            amp, floor = rng.uniform(0.25, 0.8), rng.uniform(0.01, 0.09)
            stray = floor * illum * (1 + 0.5 * _light(rng, shape))
            dirt = 0.5 * dust + 0.35 * scr
            bg = stray + dirt * guide * rng.uniform(0.1, 0.6)
            im = stray + (amp * T + amp * halo) * guide + dirt * guide * 0.3
            bg = stray + dirt * guide * 0.3
            im, bg = im + 0.6 * refl_glass + 0.8 * refl_body * guide, bg + 0.6 * refl_glass
        else:
            level, con = rng.uniform(0.4, 0.8), rng.uniform(0.25, 0.9)
            base = level * illum * (1 - 0.6 * dust) * (1 - 0.3 * scr)
            im = base * (1 - con * np.clip(T, 0, 1.05)) * (1 - 0.4 * halo)
            im, bg = im + 0.4 * refl_glass + 0.5 * refl_body, base + 0.4 * refl_glass
        im, bg = _tint(im, rgb), _tint(bg, rgb)

    elif kind == "gelsight":
        flat = bool(rng.random() < 0.35)
        extra["flat_ended"] = int(flat)
        ss = 1
        if contact:
            if flat:  # disc pressed in: flat floor
                z = -gap.punch(x, y) * a * rng.uniform(0.04, 0.12)
            else:
                z = -gap.surface(x, y)
            d_far = a * rng.uniform(1.0, 2.5)  # finite gel thickness
            out = np.sqrt(gap.lam(x, y))
            z = z * np.exp(-((out / d_far) ** 2) / 2)
        else:
            z = np.zeros(shape)
        coat = rng.uniform(0.008, 0.03) * a / mm  # painted skin bends
        extra["skin_smoothing_mm"] = coat * mm
        z = z + _smooth_noise(rng, shape, 60, 2) * a * 2e-4
        z = cv2.GaussianBlur(z, (0, 0), max(coat, 0.7)) / mm  # px
        grain = rng.uniform(0.0, 0.012) * _smooth_noise(rng, shape, 2.5)
        gr, gc = np.gradient(z)
        k = rng.uniform(1.0, 1.8)
        nr, nc, nz = -k * gr + grain, -k * gc + grain[::-1], 1.0
        nn = np.sqrt(nr**2 + nc**2 + nz)
        bgn = np.sqrt(grain**2 + grain[::-1] ** 2 + 1)
        th0 = rng.uniform(0, 2 * np.pi)
        rr, cc = np.mgrid[-1 : 1 : H * 1j, -1 : 1 : Wd * 1j]
        chans_i, chans_b = [], []
        order = rng.permutation(3)
        elev = np.deg2rad(rng.uniform(18, 40))
        for q in range(3):
            ph = th0 + 2 * np.pi * q / 3
            lr, lc, lz = np.cos(elev) * np.sin(ph), np.cos(elev) * np.cos(ph), np.sin(elev)
            fall = np.exp(0.45 * rng.uniform(0.4, 1.2) * (np.sin(ph) * rr + np.cos(ph) * cc)) * rng.uniform(
                0.75, 1.1
            )
            amb = rng.uniform(0.05, 0.15)
            chans_i.append(fall * (amb + 0.62 * np.maximum(lr * nr + lc * nc + lz * nz, 0) / nn))
            chans_b.append(fall * (amb + 0.62 * np.maximum(lr * grain + lc * grain[::-1] + lz, 0) / bgn))
        im = np.stack([chans_i[i] for i in order], -1)
        bg = np.stack([chans_b[i] for i in order], -1)
        desat = rng.uniform(0.0, 0.35)  # LED cross talk
        im = (1 - desat) * im + desat * im.mean(-1, keepdims=True)
        bg = (1 - desat) * bg + desat * bg.mean(-1, keepdims=True)
        s = 0.5 / bg.mean()
        im, bg = im * s, bg * s
        if rng.random() < 0.35:
            dist.append("markers")
            pitch, rad = H / rng.uniform(9, 14), H / rng.uniform(110, 170)
            m = np.zeros(shape, np.float32)
            m2 = np.zeros(shape, np.float32)
            for u in np.arange(pitch / 2, H, pitch):
                for v in np.arange(pitch / 2, Wd, pitch):
                    cv2.circle(m, (int(v * 16), int(u * 16)), int(rad * 16), 1.0, -1, cv2.LINE_AA, 4)
                    dr, dc = u - centre[0], v - centre[1]
                    e = max(np.hypot(dr, dc) / a_px, 0.02) if contact else 9.0
                    push = 0.06 * a_px * e * np.exp(-e * e) / max(np.hypot(dr, dc), 1e-6) if contact else 0
                    cv2.circle(
                        m2,
                        (int((v + dc * push) * 16), int((u + dr * push) * 16)),
                        int(rad * 16),
                        1.0,
                        -1,
                        cv2.LINE_AA,
                        4,
                    )
            im, bg = im * (1 - 0.85 * m2[..., None]), bg * (1 - 0.85 * m[..., None])
        wear = 1 - 0.5 * dust[..., None]
        vig = _light(rng, shape, 0.35)[..., None]
        refl = 0.35 * refl_glass[..., None]
        im, bg = im * wear * vig + refl, bg * wear * vig + refl

    elif kind == "wet":
        # moist finger or glove on glass seen against a light field: contact darker (or brighter),
        # liquid filling gaps below the meniscus height, its rim a refracting line, droplets left
        hm = a * a / R * np.exp(rng.uniform(np.log(2e-3), np.log(3e-2)))
        wob = 1 + 0.3 * _smooth_noise(rng, shape, H / rng.uniform(6, 20), 2)
        hm_map = hm * np.clip(wob, 0.35, 2)
        depth = 2e-4
        level, con, wetc = rng.uniform(0.4, 0.75), rng.uniform(0.2, 0.6), rng.uniform(0.3, 0.7)
        sign = float(rng.choice([1, 1, -1]))
        T, h = S(lambda g: np.exp(-g / depth))
        if contact:
            soft = 1 / (1 + np.exp(np.clip((h - hm_map) / (hm_map * 0.12 + 1e-9), -40, 40)))
            rim = np.exp(-(((h - hm_map) / (hm_map * 0.22)) ** 2))
            bub = _specks(rng, shape, int(rng.integers(0, 10)), rng.uniform(2, 5) * H / 500)
            hh = a * 1.0
            extra["meniscus_gap_mm"] = hm
            extra["meniscus_beyond_major_mm"], extra["meniscus_beyond_minor_mm"] = _apparent(
                gap, hm / np.log(2)
            )
        else:
            soft = rim = bub = np.zeros(shape)
        drops = _specks(rng, shape, int(rng.integers(5, 50)), rng.uniform(1, 4) * H / 500)
        dedge = np.clip(drops - cv2.GaussianBlur(drops, (0, 0), 2), 0, 1)
        cover = np.maximum(T, wetc * soft * (1 - 0.8 * bub))
        cover *= 1 + 0.06 * _smooth_noise(rng, shape, rng.uniform(5, 40), 3)
        halo = (
            rng.uniform(0, 0.25)
            * cv2.GaussianBlur(np.exp(-hfar / (a * a / R * 0.5)).astype(np.float32), (0, 0), H * 0.008)
            if hover
            else 0
        )
        base = level * illum * (1 - 0.5 * dust) * (1 - 0.3 * scr)
        if sign > 0:
            im = (
                base
                * (1 - con * cover)
                * (1 - 0.45 * rim * con)
                * (1 - halo)
                * (1 - 0.3 * drops + 0.7 * dedge)
            )
        else:
            base = base * 0.45
            im = base * (1 + 1.6 * con * cover + 0.35 * rim + halo) * (1 - 0.2 * drops + 0.8 * dedge)
        extra["dark_contact"] = int(sign > 0)
        im, bg = im + 0.4 * refl_glass + 0.4 * refl_body, base + 0.4 * refl_glass
        im, bg = _tint(im, rgb), _tint(bg, rgb)

    elif kind == "newton":
        mono = rng.random() < 0.5
        waves = [rng.uniform(450, 660) * 1e-6] if mono else [630e-6, 540e-6, 460e-6]
        dl = rng.uniform(10, 40) * 1e-6 if mono else rng.uniform(60, 100) * 1e-6
        r1, r2 = 0.04, rng.uniform(0.02, 0.04)  # glass-air, air-silicone
        floor = rng.uniform(0.0005, 0.006)  # contact + stray
        V = rng.uniform(0.7, 0.95)
        scale = rng.uniform(0.35, 0.6) / (r1 + r2)
        chan = []
        for wv in waves:

            def sig(g, wv=wv):
                coh = np.exp(-((np.pi * g * dl / wv**2 * 1.2) ** 2))
                # at zero gap the two reflections cancel to the small glass-silicone one
                I = r1 + r2 - 2 * np.sqrt(r1 * r2) * V * coh * np.cos(4 * np.pi * g / wv)
                return I + floor

            I, h = S(sig, 3.0)
            if contact:  # pixel averages out fast fringes
                g_r, g_c = np.gradient(h)
                ph = 2 * np.hypot(g_r, g_c) / wv
                slow = np.sinc(ph)
                rho = np.sqrt((x / gap.a) ** 2 + (y / gap.b) ** 2)
                far = (rho - 1) * gap.b > 3 * mm
                I = np.where(far, r1 + r2 + floor + (I - r1 - r2 - floor) * slow, I)
            chan.append(I)
        im = chan[0] * scale if mono else np.stack(chan, -1) * scale * np.array([1, 0.98, 0.93])
        if contact:  # half rise of the first fringe: gap lambda/8
            wv = waves[0] if mono else 540e-6
            extra["apparent_beyond_major_mm"], extra["apparent_beyond_minor_mm"] = _apparent(
                gap, wv / 8 / np.log(2)
            )
        extra.update(wavelength_mm=waves[0] if mono else 540e-6, bandwidth_mm=dl)
        bgv = (r1 + floor) * scale if want == "far" else (r1 + r2 + floor) * scale
        bg = np.full_like(im, 1.0) * (bgv if mono else bgv * np.array([1, 0.98, 0.93]))
        tex = 1 + 0.02 * _smooth_noise(rng, shape, rng.uniform(3, 8), 2)
        fld = illum
        if rng.random() < 0.45:  # round field stop
            rr, cc = np.mgrid[0:H, 0:Wd]
            rf = rng.uniform(0.52, 0.62) * np.hypot(H, Wd)
            d = np.hypot(rr - H / 2, cc - Wd / 2) - rf
            fld = fld * (0.03 + 0.97 / (1 + np.exp(np.clip(d / (H * 0.006), -60, 60))))
            dist.append("field_stop")
        defoc = cv2.GaussianBlur(dust, (0, 0), rng.uniform(0.5, 4))
        m = fld * (1 - 0.5 * defoc) * (1 - 0.2 * scr)
        ghost = 0.15 * refl_glass  # lens ghost
        ex = (lambda q: q[..., None]) if not mono else (lambda q: q)
        im, bg = im * ex(m * tex) + ex(ghost), bg * ex(m) + ex(ghost)
    else:
        raise ValueError(kind)
    if drift > 1.01 or drift < 0.99:
        dist.append("light_drift")
    if noise is not None:
        look.rng = noise
    image, back = look.expose(im * drift), look.expose(bg)
    if look.jpeg:
        dist.append("jpeg")
    if look.read > 1.5 or look.full < 3000:
        dist.append("noisy")
    truth = dict(
        contact=int(contact),
        inside_frame=int(contact and not cut),
        semi_major_mm=gap.a if contact else 0.0,
        semi_minor_mm=gap.b if contact else 0.0,
        angle=ang if contact else 0.0,
        centre_px=(float(centre[0]), float(centre[1])) if contact else (-1.0, -1.0),
        area_mm2=float(np.pi * gap.a * gap.b) if contact else 0.0,
        radius_of_curvature_mm=float(R),
        adhesive_stretch_mm=float(gap.stretch),
        psf_sigma_px=float(look.psf),
        gamma=look.gamma,
        jpeg_quality=look.jpeg,
        light_drift=float(drift),
    )
    truth.update({q: float(v) for q, v in extra.items()})
    return dict(
        image=image, background=back, mm_per_px=mm, kind=kind, truth=truth, disturbances=sorted(set(dist))
    )


def pictures(seed, count, kind="ftir"):
    """Yield `count` dicts: image, background (uint8, HxW or HxWx3 RGB), mm_per_px, kind,
    disturbances (list of names), truth (plain numbers; centre_px a pair row, column)."""
    if kind not in KINDS:
        raise ValueError(f"kind must be one of {KINDS}")
    base = KINDS[:5]
    for j in range(count):
        rng = np.random.default_rng([seed, j, KINDS.index(kind)])
        if kind == "none":
            k = base[j % 5]
            p = _scene(rng, k, contact=False, want="hover" if rng.random() < 0.4 else "bare")
            p["disturbances"].append("no_contact")
        elif kind == "cut":
            p = _scene(rng, base[j % 5], cut=True)
            p["disturbances"].append("cut_by_frame")
        else:
            p = _scene(rng, kind)
        p["optics"], p["kind"] = p["kind"], kind
        yield p


def loading(seed, count, kind="ftir"):
    """Yield one press as by `pictures`: the view before touch, then `count` frames in which the load
    grows evenly up to the last, and the contact's radius as its cube root (Hertz)."""
    for k in range(count + 1):
        p = _scene(
            np.random.default_rng([seed, KINDS.index(kind), 99]),
            kind,
            grown=(max(k, 1) / count) ** (1 / 3),
            noise=np.random.default_rng([seed, k]),
        )
        if k == 0:
            p["image"] = p["background"]
            p["truth"] = p["truth"] | {"contact": 0, "area_mm2": 0.0}
        yield p
