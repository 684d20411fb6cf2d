"""The finger's silhouette before a plain backdrop, in whole pixels of a reduced copy of the photograph."""

import math
from typing import Any, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from fingerpad._arrays import BoolArray, FloatArray
from fingerpad.exceptions import ImageError
from fingerpad.image._masks import fill_holes, longest_contour
from fingerpad.image.levels import LUMA, linear_light
from fingerpad.image.photograph.faces import STEPS, Direction

_SIDE_PX = 900
_MIN_SIDE_PX = 32
# Distances are counted in standard deviations of the backdrop.
_MIN_DISTANCE = 5.0
_SHARE_OF_CONTRAST = 0.3
_MIN_AREA_SHARE = 0.004
_MAX_AREA_SHARE = 0.92
_SMOOTHING_PX = 3.0


class Silhouette(NamedTuple):
    """A finger set apart from its backdrop."""

    mask: BoolArray  # the finger, in a reduced copy
    reduction: float  # pixels of the photograph per pixel of the copy

    def contour(self) -> FloatArray:
        """Return its outline, (row, column) in px of the photograph, in order, without the frame."""
        longest = longest_contour(self.mask)[:, 0, ::-1].astype(np.float64)
        rows, columns = self.mask.shape
        framed = (longest.min(axis=1) <= 1) | (longest[:, 0] >= rows - 2) | (longest[:, 1] >= columns - 2)
        if framed.all():
            return np.empty((0, 2))
        if framed.any():
            # The longest stretch between two meetings with the frame.
            turned = np.roll(longest, -int(np.argmax(framed)), axis=0)
            cuts = np.flatnonzero(np.roll(framed, -int(np.argmax(framed))))
            stretches = np.diff(np.append(cuts, len(turned)))
            k = int(np.argmax(stretches))
            longest = turned[cuts[k] + 1 : cuts[k] + stretches[k]]
            # The contour of a mask runs along its pixels' middles, half a pixel inside.
        smooth = _smooth_contour(longest, closed=not framed.any())
        return (smooth + 0.5) * self.reduction - 0.5

    def cut_sides(self) -> dict[Direction, npt.NDArray[np.intp]]:
        """Return the sides of the frame that cut the finger, with the cut's rows or columns in the copy."""
        bands: dict[Direction, BoolArray] = {
            "up": self.mask[:2],
            "down": self.mask[-2:],
            "left": self.mask[:, :2].T,
            "right": self.mask[:, -2:].T,
        }
        cuts = {side: np.flatnonzero(band.any(axis=0)) for side, band in bands.items()}
        return {side: cut for side, cut in cuts.items() if cut.size > 2}

    def check_not_cut(self, sides: tuple[Direction, ...], tip: Direction) -> None:
        """Refuse a finger whose pad lies on the frame."""
        finger = np.flatnonzero(self.mask.any(axis=1 if tip in ("up", "down") else 0))
        cuts = self.cut_sides()
        for side, cut in ((side, cuts[side]) for side in sides if side in cuts):
            # A tilted finger may leave through a side; its half at the tip may not.
            depth = cut[0] - finger[0] if tip in ("up", "left") else finger[-1] - cut[-1]
            if side == tip or len(sides) == 1 or depth < (finger[-1] - finger[0]) / 2:
                raise ImageError(
                    f"the frame cuts the finger on its {side} side, where the pad is: leave a margin there, "
                    "give region_of_interest or points for the part that shows, or check tip and palmar"
                )


def opponent_light(pixels: npt.NDArray[Any]) -> npt.NDArray[np.float32]:
    """Return luma as light, then red and blue beyond it; luma alone for a grey picture.

    Cameras' files keep luma sharp and colour at half the resolution: apart, each is trusted as it deserves.
    """
    if pixels.ndim == 2:
        return linear_light(pixels)[..., None]
    light = linear_light(pixels[..., :3])
    luma = light @ LUMA
    np.subtract(light[..., 0], luma, out=light[..., 1])
    light[..., 2] -= luma
    light[..., 0] = luma
    return light


def find_silhouette(
    light: npt.NDArray[np.float32], root: Direction | None, window: tuple[slice, slice] | None
) -> Silhouette:
    """Set the finger apart from the backdrop whose colour is that of the frame's border.

    `root` is the side of the frame through which the finger comes in, None when it is seen end on; `window`
    is where the finger that is meant lies, if it need not be the largest.
    """
    reduction = max(1.0, max(light.shape[:2]) / _SIDE_PX)
    rows, columns = (max(1, round(side / reduction)) for side in light.shape[:2])
    if min(rows, columns) < _MIN_SIDE_PX:
        raise ImageError(
            f"a photograph of {light.shape[0]} × {light.shape[1]} pixels is too small: "
            f"{_MIN_SIDE_PX} px a side are the least"
        )
    small = np.asarray(cv2.resize(light, (columns, rows), interpolation=cv2.INTER_AREA), dtype=np.float32)
    small = np.asarray(cv2.GaussianBlur(small, (0, 0), 1.2), dtype=np.float32).reshape(rows, columns, -1)
    off, noise = _off_backdrop(small, root)
    # Channel by channel, since sums over three neighbours in memory take several times as long.
    whitened = cv2.split(cv2.transform(off, np.linalg.inv(np.linalg.cholesky(noise))))
    distance = np.sqrt(sum(part * part for part in whitened))
    first, second = (
        slice(int(part.start / reduction), math.ceil(part.stop / reduction))
        for part in window or (slice(0, light.shape[0]), slice(0, light.shape[1]))
    )
    return Silhouette(_component(_finger(distance), (first, second)), reduction)


def _off_backdrop(small: npt.NDArray[np.float32], root: Direction | None) -> tuple[FloatArray, FloatArray]:
    """Return what each pixel has beyond the backdrop, a smooth surface through the border, and its noise."""
    rows, columns = small.shape[:2]
    band = max(3, round(0.025 * min(rows, columns)))
    border = np.ones((rows, columns), dtype=bool)
    border[band:-band, band:-band] = False
    if root is not None:
        step = STEPS[root]
        cut = np.arange(rows)[:, None] * step[0] + np.arange(columns)[None, :] * step[1]
        border &= cut < cut.max() - 2 * band
    down, across = np.linspace(-1, 1, rows)[:, None], np.linspace(-1, 1, columns)
    y, x = (np.broadcast_to(part, border.shape)[border] for part in (down, across))
    design = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=-1)
    colours = small[border].astype(np.float64)
    good = _nearest_half(colours)
    floor = np.eye(colours.shape[1]) * 1e-6
    for order in (1, 3, 3, 6, 6, 6):
        factors = np.linalg.lstsq(design[good, :order], colours[good], rcond=None)[0]
        left = colours - design[:, :order] @ factors
        noise = left[good].T @ left[good] / good.sum() + floor
        far = np.sqrt(np.sum(left @ np.linalg.inv(noise) * left, axis=1))
        good = far < max(4.0, 2 * float(np.median(far[good])))
    if good.mean() < 0.4:
        raise ImageError(
            f"only {good.mean():.0%} of the frame's border shows one backdrop: "
            "photograph the finger before a plain backdrop, and leave a margin round the pad"
        )
    surfaces = [
        (a + b * across + d * across**2) + (c + e * across) * down + f * down**2
        for a, b, c, d, e, f in factors.T
    ]
    off = cv2.subtract(small, cv2.merge(surfaces), dtype=cv2.CV_64F).reshape(small.shape)
    return np.asarray(off, dtype=np.float64), noise


def _nearest_half(colours: FloatArray) -> BoolArray:
    """Return which colours lie nearest to the commonest one."""
    far = np.abs(colours - np.median(colours, axis=0)).sum(axis=1)
    for _ in range(5):
        near = far <= np.quantile(far, 0.6)
        far = np.abs(colours - colours[near].mean(axis=0)).sum(axis=1)
    return np.asarray(far <= np.quantile(far, 0.6), dtype=bool)


def _finger(distance: FloatArray) -> BoolArray:
    """Return what stands out from the backdrop."""
    level = np.clip(np.log1p(distance) * 40, 0, 255).astype(np.uint8)
    otsu, _ = cv2.threshold(level, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    out = distance > max(_MIN_DISTANCE, math.expm1(otsu / 40))
    if out.mean() < _MIN_AREA_SHARE:
        raise ImageError(
            f"no finger found, {out.mean():.1%} of the photograph stands out from the backdrop: "
            "choose a backdrop of another colour than the skin, or come nearer"
        )
    mask = distance > max(_MIN_DISTANCE, _SHARE_OF_CONTRAST * float(np.median(distance[out])))
    if mask.mean() > _MAX_AREA_SHARE:
        raise ImageError(f"{mask.mean():.0%} of the photograph would be finger: leave a margin of backdrop")
    return np.asarray(mask, dtype=bool)


def _component(mask: BoolArray, window: tuple[slice, slice]) -> BoolArray:
    """Return the region that fills most of the window, without holes."""
    size = max(3, round(0.006 * max(mask.shape)) | 1)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))
    padded = cv2.copyMakeBorder(mask.astype(np.uint8), size, size, size, size, cv2.BORDER_REPLICATE)
    opened = cv2.morphologyEx(cv2.morphologyEx(padded, cv2.MORPH_CLOSE, kernel), cv2.MORPH_OPEN, kernel)
    _, labels = cv2.connectedComponents(opened[size:-size, size:-size])
    counts = np.bincount(labels[window].ravel(), minlength=labels.max() + 1)
    counts[0] = 0
    if counts.max() < _MIN_AREA_SHARE * mask.size / 4:
        raise ImageError(
            "no finger found where it was looked for: move region_of_interest, or leave it out"
            if counts.max() < np.bincount(labels.ravel())[1:].max(initial=0)
            else "no finger found, only specks stand out from the backdrop: come nearer"
        )
    return fill_holes(labels == counts.argmax())


def _smooth_contour(points: FloatArray, *, closed: bool) -> FloatArray:
    """Return a pixel contour without its stairs, the ends of an open one in place."""
    reach = math.ceil(4 * _SMOOTHING_PX)
    if len(points) < 2 * reach:
        return points
    mode: dict[str, Any] = {"mode": "wrap"} if closed else {"mode": "reflect", "reflect_type": "odd"}
    padded = np.pad(points, ((reach, reach), (0, 0)), **mode)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / _SMOOTHING_PX) ** 2)
    weights /= weights.sum()
    return np.stack([np.convolve(part, weights, mode="valid") for part in padded.T], axis=-1)
