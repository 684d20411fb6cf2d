"""Measured imprints: known truth, invariances, disturbances, real prints, and what cannot be measured."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest
from benchmarks.truth import elastic_ridges, image_sets
from benchmarks.truth.independent_images import CONDITIONS, render
from benchmarks.truth.true_image import named_rng
from PIL import Image
from skimage.measure import label, regionprops

from fingerpad.exceptions import ImageError
from fingerpad.image import Scale, measure_contact_image, prepare_contact_image
from fingerpad.image.contact_image.view import crop
from fingerpad.simulate import render_contact_image

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
LIVE = DATA / "nist_nbis_livescan_slaps"
INK = DATA / "nist_minex_ink"
real = pytest.mark.skipif(not LIVE.is_dir(), reason=f"real prints are not in {DATA}")
PPI_500 = Scale.of_ppi(500)


@cache
def load(path):
    return np.asarray(Image.open(path).convert("L"))


@cache
def measured(path):
    return measure_contact_image(load(path), PPI_500)


def drawn_ellipse(rng, longest):
    area, ratio = rng.uniform(100, 300), rng.uniform(1.0, longest)
    semi_minor = math.sqrt(area / math.pi / ratio)
    return {"semi_major": ratio * semi_minor, "semi_minor": semi_minor, "orientation": rng.uniform(-1.5, 1.5)}


def truths():
    """Contacts of every pattern, look and noise, each with each."""
    rng = np.random.default_rng(11)
    for k in range(9):
        yield render_contact_image(
            **drawn_ellipse(rng, 1.7),
            ridge_period=rng.uniform(0.4, 0.52),
            pattern=("arch", "loop", "whorl")[k % 3],
            look=("ink", "livescan", "prism")[k // 3],
            lighting=rng.uniform(0, 0.3),
            noise_std=(4, 12, 25)[(k + k // 3) % 3],
            seed=200 + k % 3,
        )


def test_known_truth():
    pairs = [(truth, measure_contact_image(truth.pixels, PPI_500)) for truth in truths()]
    area = np.array([found.gross_area / truth.gross_area - 1 for truth, found in pairs])
    assert abs(area.mean()) < 0.01
    assert np.abs(area).max() < 0.03
    for truth, found in pairs:
        assert float(found.ellipse.semi_major) == pytest.approx(float(truth.ellipse.semi_major), rel=0.02)
        assert float(found.ellipse.semi_minor) == pytest.approx(float(truth.ellipse.semi_minor), rel=0.02)
        if float(truth.ellipse.axis_ratio) < 1 / 1.2:
            off = math.degrees(math.asin(math.sin(found.orientation - truth.orientation)))
            assert abs(off) < 2
        assert math.dist(found.centroid, truth.centroid) < 2
        assert found.ridge_period == pytest.approx(truth.ridge_period, rel=0.06)
        assert found.ridge_area == pytest.approx(truth.ridge_area, rel=0.06)
        assert found.flags == ()


def test_noise_edge_and_scale_add_up():
    truth = render_contact_image(semi_major=8, semi_minor=6, seed=1)
    exact, vague = (measure_contact_image(truth.pixels, scale) for scale in (PPI_500, Scale.of_ppi(500, 5)))
    np.testing.assert_allclose(exact.noise_covariance, vague.noise_covariance, rtol=1e-9)
    np.testing.assert_allclose(
        vague.covariance,
        vague.noise_covariance
        + np.outer(vague.edge_effect, vague.edge_effect)
        + np.outer(vague.scale_effect, vague.scale_effect),
    )
    assert not exact.scale_effect.any()
    offset = exact.edge_offset_std
    assert offset == exact.as_record()["edge_offset_mm_std"]
    # About 0.09 ridge periods for a sharp edge; all round, they widen the area by the outline's length.
    assert 0.07 < offset / exact.ridge_period < 0.12
    around = 2 * np.pi * np.sqrt((8**2 + 6**2) / 2)
    assert exact.edge_effect[2] == pytest.approx(offset * around, rel=0.02)
    record = vague.as_record()
    parts = [record["gross_area_mm2_noise_std"], record["gross_area_mm2_edge_std"], 0.02 * vague.gross_area]
    assert record["gross_area_mm2_std"] == pytest.approx(np.linalg.norm(parts), rel=1e-9)


def test_the_edge_is_less_certain_where_ridges_fade_not_where_a_picture_is_noisy():
    clean = CONDITIONS["clean, sharp edge"]
    sharp, noisy, soft = (
        measure_contact_image(image.pixels, image.mm_per_px)
        for image in (
            render(np.random.default_rng(1), replace(clean, **more))
            for more in ({}, {"noise": 0.04}, {"width_fade": 1.0, "contrast_fade": 1.0})
        )
    )
    assert noisy.edge_offset_std == pytest.approx(sharp.edge_offset_std, rel=0.1)
    assert soft.edge_offset_std > 2 * sharp.edge_offset_std
    assert soft.noise_covariance[2, 2] > 1.5 * sharp.noise_covariance[2, 2]


def test_the_edge_of_a_light_touch_is_less_certain():
    light, firm = (
        measure_contact_image(truth.pixels, truth.mm_per_px).edge_offset_std
        for truth in (render_contact_image(semi_major=size, semi_minor=size, seed=1) for size in (2.5, 8))
    )
    assert light > 1.3 * firm


def test_ridges_that_thin_steeply_tell_of_an_edge_beyond_them():
    bell = replace(elastic_ridges.CONDITIONS["bell-shaped pressure"], area=(70, 90), pixel=(0.05, 0.05))
    truth = elastic_ridges.render(named_rng(5, "bell", 1), bell)
    found = measure_contact_image(truth.pixels, truth.mm_per_px)
    assert abs(found.gross_area - truth.gross_area) < 1.96 * found.gross_area_std < 0.1 * truth.gross_area


def test_a_halo_widens_the_interval_but_does_not_move_the_edge():
    truth = render_contact_image(seed=4, noise_std=4)
    plain = measure_contact_image(truth.pixels, PPI_500)
    outside = cv2.distanceTransform((~plain.region).astype(np.uint8), cv2.DIST_L2, 5) * truth.mm_per_px
    haloed = np.rint(truth.pixels * (1 - 0.2 * np.exp(-outside / 0.5))).astype(np.uint8)
    found = measure_contact_image(haloed, PPI_500)
    assert found.gross_area == pytest.approx(plain.gross_area, rel=0.01)
    assert found.gross_area_std > 1.5 * plain.gross_area_std
    assert found.ridge_area_std > 1.5 * plain.ridge_area_std


def test_semi_axes_are_less_certain_where_the_outline_is_no_ellipse():
    truth = render_contact_image(semi_major=8, semi_minor=6, seed=1)
    rows, columns = np.indices(truth.pixels.shape)
    half = np.array([6.5, 5.0]) / truth.mm_per_px  # within the ellipse's corners
    level = sum(
        np.abs((at - centre) / length) ** 4
        for at, centre, length in zip((rows, columns), truth.centroid, half, strict=True)
    )
    box = measure_contact_image(np.where(level < 1, truth.pixels, 240).astype(np.uint8), PPI_500)
    round_ = measure_contact_image(truth.pixels, PPI_500)
    assert box.semi_major_std / box.ellipse.semi_major > 2 * round_.semi_major_std / round_.ellipse.semi_major
    # The ellipse of equal area is longer than the box is.
    assert abs(float(box.ellipse.semi_major) - 6.5) < 1.96 * box.semi_major_std


def test_mask():
    left, right = (render_contact_image(semi_major=8, semi_minor=6, seed=s, margin=1.5) for s in (7, 8))
    pixels = beside(left.pixels, right.pixels)
    rows, columns = pixels.shape
    middle = left.pixels.shape[1]
    corners = [(0, middle), (0, columns), (rows, columns), (rows, middle)]
    inside = np.zeros(pixels.shape, dtype=bool)
    inside[:, middle:] = True
    for mask in (corners, inside):
        found = measure_contact_image(pixels, PPI_500, mask=mask)
        assert found.flags == ()
        assert found.gross_area == pytest.approx(right.gross_area, rel=0.01)
        assert math.dist(found.centroid, (right.centroid[0], right.centroid[1] + middle)) < 1
        assert found.region.shape == pixels.shape
    half = np.zeros(pixels.shape, dtype=bool)
    half[:, : middle // 2] = True
    assert "cut_by_mask" in measure_contact_image(pixels, PPI_500, mask=half).flags


def test_region_of_interest_equals_crop():
    truth = render_contact_image(seed=3, margin=4)
    rows, columns = truth.pixels.shape
    whole = measure_contact_image(truth.pixels, PPI_500)
    part = measure_contact_image(truth.pixels, PPI_500, region_of_interest=(40, 30, rows - 35, columns - 45))
    assert part.flags == ()
    assert part.gross_area == pytest.approx(whole.gross_area, rel=0.005)
    assert math.dist(part.centroid, whole.centroid) < 0.5
    assert (part.region ^ whole.region).mean() < 0.005
    cut = measure_contact_image(truth.pixels, PPI_500, region_of_interest=(rows // 2, 0, rows, columns))
    assert "cut_by_mask" in cut.flags
    assert "touches_border" not in cut.flags


def test_ellipse_agrees_with_a_second_implementation():
    found = measure_contact_image(render_contact_image(seed=2, orientation=-0.7).pixels, PPI_500)
    props = regionprops(label(found.region))[0]
    assert found.orientation == pytest.approx(props.orientation, abs=2e-3)
    assert found.as_record()["orientation_deg"] == pytest.approx(math.degrees(found.orientation))
    assert found.gross_area == pytest.approx(props.area * 0.0508**2, rel=2e-3)
    assert found.ridge_area == pytest.approx(found.ridges.sum() * 0.0508**2, rel=0.04)
    assert float(found.ellipse.semi_major) == pytest.approx(props.axis_major_length / 2 * 0.0508, rel=0.01)
    assert found.centroid == pytest.approx(props.centroid, abs=0.1)
    assert (found.region | ~found.ridges).all()


@cache
def pictures():
    found = {"synthetic": render_contact_image(seed=4, orientation=0.3, noise_std=5).pixels}
    if LIVE.is_dir():
        # Room for the crop to turn in, of its own ground.
        found["real"] = np.pad(load(LIVE / "left_ring_500ppi.png"), 60, constant_values=253)
    return [(name, pixels, measure_contact_image(pixels, PPI_500)) for name, pixels in found.items()]


def turned(pixels, degrees, *, level=None):
    rows, columns = pixels.shape
    matrix = cv2.getRotationMatrix2D(((columns - 1) / 2, (rows - 1) / 2), degrees, 1)
    side = math.ceil(math.hypot(rows, columns))
    matrix[:, 2] += (side - columns) / 2, (side - rows) / 2
    level = float(np.median(pixels[:5])) if level is None else level
    return cv2.warpAffine(pixels, matrix, (side, side), flags=cv2.INTER_CUBIC, borderValue=level)


CHANGES = {
    "turned by 30": (lambda p: turned(p, 30), 1, lambda angle: angle + math.pi / 6),
    "mirrored": (lambda p: p[:, ::-1], 1, lambda angle: -angle),
    "inverted": (lambda p: 255 - p, 1, lambda angle: angle),
    "deeper": (lambda p: p.astype(np.uint16) * 257, 1, lambda angle: angle),
    "enlarged by a fraction": (
        lambda p: cv2.resize(p, None, fx=1.375, fy=1.375, interpolation=cv2.INTER_CUBIC),
        1.375,
        lambda angle: angle,
    ),
}


@pytest.mark.parametrize("change", CHANGES)
def test_invariance(change):
    alter, factor, turn = CHANGES[change]
    for name, pixels, plain in pictures():
        other = measure_contact_image(alter(pixels), Scale.of_ppi(500 * factor))
        assert other.gross_area == pytest.approx(plain.gross_area, rel=0.015), name
        for axis in ("semi_major", "semi_minor"):
            assert getattr(other.ellipse, axis) == pytest.approx(getattr(plain.ellipse, axis), rel=0.015)
        assert math.sin(other.orientation - turn(plain.orientation)) == pytest.approx(0, abs=0.03)
        assert other.ridge_period == pytest.approx(plain.ridge_period, rel=0.04)


def test_background_removes_stain():
    truth = render_contact_image(seed=5, noise_std=3, lighting=0.0)
    rows, columns = np.indices(truth.pixels.shape)
    ground = 1 - 0.5 * np.exp(-((rows - 80) ** 2 + (columns - 90) ** 2) / 2 / 50**2)
    found = measure_contact_image(truth.pixels * ground, PPI_500, background=200 * ground)
    assert found.gross_area == pytest.approx(truth.gross_area, rel=0.02)


def with_text(pixels, words, corner, *, font=cv2.FONT_HERSHEY_SIMPLEX, height=20, stroke=4):
    size = cv2.getFontScaleFromHeight(font, height, stroke)
    return cv2.putText(pixels.copy(), words, corner, font, size, 0, stroke, cv2.LINE_AA)


def with_dust(pixels):
    out = pixels.copy()
    for row, column in np.random.default_rng(0).integers(0, pixels.shape, (150, 2)):
        cv2.circle(out, (int(column), int(row)), 2, 0, -1)
    return out


OBSTRUCTIONS = {
    "text": lambda pixels: with_text(pixels, "FINGERS TAKEN", (10, 24), stroke=3),
    # A line of print that touches the fingertip: its closed letters are a band.
    "heading": lambda pixels: with_text(pixels, "EHEHEHEHEHEHEHE", (5, 95)),
    "pen line": lambda pixels: cv2.line(pixels.copy(), (0, 300), (pixels.shape[1], 120), 0, 4),
    "dust": with_dust,
    "white border": lambda pixels: turned(pixels, 12, level=255),
}


@pytest.mark.parametrize("spoil", OBSTRUCTIONS.values(), ids=OBSTRUCTIONS)
def test_obstructions(spoil):
    truth = render_contact_image(seed=6, look="ink", noise_std=6, margin=3)
    found = measure_contact_image(spoil(truth.pixels), PPI_500)
    assert found.gross_area == pytest.approx(truth.gross_area, rel=0.02)
    assert float(found.ellipse.semi_major) == pytest.approx(float(truth.ellipse.semi_major), rel=0.03)
    assert "touches_border" not in found.flags


@pytest.mark.parametrize(
    ("look", "height", "stroke", "font"),
    [
        ("ink", 34, 5, cv2.FONT_HERSHEY_SIMPLEX),
        ("livescan", 48, 8, cv2.FONT_HERSHEY_COMPLEX),
        ("livescan", 34, 5, cv2.FONT_HERSHEY_SCRIPT_COMPLEX),
    ],
)
def test_letters_across_a_contact_are_flagged(look, height, stroke, font):
    truth = render_contact_image(seed=6, look=look, noise_std=6, margin=3)
    corner = (5, truth.pixels.shape[0] // 4)
    pixels = with_text(truth.pixels, "FINGERS TAKEN SIMUL", corner, font=font, height=height, stroke=stroke)
    found = measure_contact_image(pixels, PPI_500)
    assert found.flags == ("printed_marks",)
    assert found.gross_area == pytest.approx(truth.gross_area, rel=0.04)


@real
def test_form_text_in_real_prints_is_flagged():
    paths = [path for path in INK.glob("*.pgm") if path.stem != "a999_01p"]  # blank
    for path in paths:
        assert "touches_border" in measured(path).flags
        assert 150 < measured(path).gross_area < 460
    with pytest.raises(ImageError, match="no contact found"):
        measured(INK / "a999_01p.pgm")
    flagged = {path.stem for path in paths if "printed_marks" in measured(path).flags}
    assert flagged == {"a001_03p", "a001_04p", "b001_04p", "b001_08p"}


def beside(*pictures, gap=0):
    height = max(p.shape[0] for p in pictures)
    padded = [np.pad(p, ((0, height - p.shape[0]), (0, gap)), mode="edge") for p in pictures]
    return np.hstack(padded)


@pytest.mark.parametrize("transposed", [False, True])
def test_a_seed_is_a_place_of_the_whole_picture_also_within_a_region(transposed):
    pads = [render_contact_image(semi_major=a, semi_minor=a, seed=7, margin=1, ppi=250) for a in (6, 5, 4)]
    pixels, ends = beside(*(pad.pixels for pad in pads)), np.cumsum([pad.pixels.shape[1] for pad in pads])
    places = [
        (pad.centroid[0], pad.centroid[1] + start) for pad, start in zip(pads, (0, *ends), strict=False)
    ]

    def measured(place, first, last):
        region = (0, ends[first] if first >= 0 else 0, pixels.shape[0], ends[last])
        if not transposed:
            return measure_contact_image(pixels, Scale.of_ppi(250), seed=place, region_of_interest=region)
        turned = (region[1], region[0], region[3], region[2])
        return measure_contact_image(pixels.T, Scale.of_ppi(250), seed=place[::-1], region_of_interest=turned)

    for number in (1, 2):
        found = measured(places[number], 0, 2)
        assert math.dist(found.centroid, places[number][:: -1 if transposed else 1]) < 3
        assert found.gross_area == pytest.approx(pads[number].gross_area, rel=0.04)
    with pytest.raises(ImageError, match="no contact found at seed"):
        measured(places[0], 0, 2)
    with pytest.raises(ImageError, match="no contact found at seed"):
        measured(places[2], -1, 1)


@pytest.mark.parametrize(
    ("column", "region", "expected"),
    [
        (50, None, (35, 51)),
        (0, None, (0, 16)),
        (99, None, (84, 100)),
        (22, (0, 20, 80, 60), (20, 36)),
        (59, (0, 20, 80, 60), (44, 60)),
    ],
)
def test_a_narrow_mask_keeps_the_least_side(column, region, expected):
    pixels = np.add.outer(np.arange(80.0), np.arange(100.0))
    mask = np.zeros(pixels.shape, bool)
    mask[10:70, column] = True
    part = crop(pixels, mask=mask, region_of_interest=region)
    first, last = expected
    assert part.corner == (10, first)
    np.testing.assert_array_equal(part.pixels, pixels[10:70, first:last])
    np.testing.assert_array_equal(part.inside, mask[10:70, first:last])


@pytest.mark.parametrize("kind", [np.uint8, np.int8, np.int16, np.float32])
def test_a_polygon_of_small_numbers_is_where_it_was_drawn(kind):
    pixels = np.add.outer(np.arange(130.0), np.arange(140.0))
    corners = np.array([(20, 30), (20, 120), (110, 120), (110, 30)], dtype=kind)
    part = crop(pixels, mask=corners)
    assert part.corner == (20, 30)
    np.testing.assert_array_equal(part.inside, np.ones((91, 91), bool))


def test_cut_at_joint_crease():
    tip = render_contact_image(semi_major=9, semi_minor=7, seed=8, look="ink", noise_std=5, margin=2)
    rest = render_contact_image(semi_major=7, semi_minor=6, seed=9, look="ink", noise_std=5, margin=2)
    height = tip.pixels.shape[0] + rest.pixels.shape[0]
    pixels = np.full((height, tip.pixels.shape[1]), 225, np.uint8)
    pixels[: tip.pixels.shape[0]] = tip.pixels
    # The two prints overlap by a millimetre: one region with a neck.
    top = round(tip.centroid[0] + (9 + 7 - 1) / tip.mm_per_px - rest.centroid[0])
    left = round(tip.centroid[1] - rest.centroid[1])
    place = np.s_[top : top + rest.pixels.shape[0], left : left + rest.pixels.shape[1]]
    pixels[place] = np.minimum(pixels[place], rest.pixels)
    found = measure_contact_image(pixels, PPI_500)
    assert found.gross_area == pytest.approx(tip.gross_area, rel=0.05)


BORDERS = {
    **{f"turned by {90 * k}": lambda cut, k=k: np.rot90(cut, k) for k in range(4)},
    "within an added border": lambda cut: turned(cut, 12, level=255),
}


@pytest.mark.parametrize("alter", BORDERS.values(), ids=BORDERS)
def test_cut_patch_touches_border(alter):
    pixels = alter(render_contact_image(seed=1, look="ink").pixels[90:])
    assert "touches_border" in measure_contact_image(pixels, PPI_500).flags


def test_a_side_that_was_erased_is_straight():
    pixels = render_contact_image(seed=2, look="ink").pixels
    assert "straight_side" not in measure_contact_image(pixels, PPI_500).flags
    pixels[:125] = 225
    assert "straight_side" in measure_contact_image(pixels, PPI_500).flags


ROUND = {"semi_major": 5.5, "semi_minor": 5.5, "seed": 2, "margin": 5.0}


def from_middle(truth):
    """How far each pixel lies from the contact's centre, mm."""
    y, x = np.indices(truth.pixels.shape)
    return np.hypot(y - truth.centroid[0], x - truth.centroid[1]) * truth.mm_per_px


@pytest.mark.parametrize("surround", [120, 20])
def test_window_in_dark_mount(surround):
    truth = render_contact_image(**ROUND)
    ring = from_middle(truth)
    pixels = np.where(ring < 9, truth.pixels, surround).astype(np.uint8)
    found = measure_contact_image(pixels, PPI_500)
    if surround == 20:  # the window itself was taken for the contact
        assert "edge_without_ridges" in found.flags
        found = measure_contact_image(pixels, PPI_500, mask=ring < 8.5)
    assert found.gross_area == pytest.approx(truth.gross_area, rel=0.03)
    assert not found.flags


def test_a_dark_rim_is_not_measured_as_its_negative():
    image = image_sets.draw("stripes", "prism, dark rim", 5, 8)
    found = measure_contact_image(image.pixels, Scale(image.mm_per_px))
    assert found.dark_on_light
    assert found.gross_area == pytest.approx(image.gross_area, rel=0.1)


@pytest.mark.parametrize("corner", [0.5, 0.05])
def test_dark_corners(corner):
    truth = render_contact_image(**ROUND)
    ring = from_middle(truth)
    found = measure_contact_image(truth.pixels * (1 - (1 - corner) * (ring / ring.max()) ** 2), PPI_500)
    assert found.gross_area == pytest.approx(truth.gross_area, rel=0.03)
    assert not found.flags


@pytest.mark.parametrize(("width", "share"), [(0.6, 0.6), (1.5, 0.8), (0.8, 0.5)])
def test_halo_flagged(width, share):
    truth = render_contact_image(**ROUND)
    ground, ridge, ring = np.median(truth.pixels), np.percentile(truth.pixels, 2), from_middle(truth)
    halo = (ring > 5.5) & (ring < 5.5 + width)
    pixels = np.where(halo, np.minimum(truth.pixels, ground - share * (ground - ridge)), truth.pixels)
    assert "edge_without_ridges" in measure_contact_image(pixels, PPI_500).flags


@pytest.mark.parametrize("ppi", [200, 1200])
def test_wrong_scale_flagged(ppi):
    found = measure_contact_image(render_contact_image(seed=1).pixels, Scale.of_ppi(ppi))
    assert "scale_doubtful" in found.flags


def test_contact_without_ridges_flagged():
    pixels = np.full((400, 400), 230, np.uint8)
    cv2.ellipse(pixels, (200, 200), (110, 160), 0, 0, 360, 60, -1)
    found = measure_contact_image(pixels, PPI_500)
    assert math.isnan(found.ridge_period)
    assert "scale_doubtful" in found.flags
    gross_area = np.count_nonzero(pixels == 60) * 0.0508**2
    assert found.gross_area == pytest.approx(gross_area, rel=0.015)
    for value, std in ((found.gross_area, found.gross_area_std), (found.ridge_area, found.ridge_area_std)):
        assert abs(value - gross_area) < 1.96 * std


@pytest.mark.parametrize("dark_on_light", [True, False])
def test_background_from_quiet_border(dark_on_light):
    # The contact is quiet too, and larger than the ground.
    pixels = np.full((360, 260), 200, np.float64)
    cv2.ellipse(pixels, (130, 180), (110, 160), 0, 0, 360, 60, -1)
    pixels = cv2.GaussianBlur(pixels, (0, 0), 3) * np.linspace(1, 0.7, 260)
    pixels += np.random.default_rng(0).normal(0, 12, pixels.shape)
    found = measure_contact_image(pixels if dark_on_light else 255 - pixels, PPI_500)
    assert found.dark_on_light == dark_on_light
    assert found.gross_area == pytest.approx(math.pi * 110 * 160 * 0.0508**2, rel=0.015)


def test_other_patches_count_if_ridged():
    # A piece of a print, and a smear, of 15 % of the contact's area.
    large, small = (render_contact_image(semi_major=a, semi_minor=0.75 * a, seed=7) for a in (9.0, 3.5))
    found = [
        measure_contact_image(beside(large.pixels, other), PPI_500)
        for other in (small.pixels, cv2.GaussianBlur(small.pixels, (0, 0), 8))
    ]
    assert [contact.flags for contact in found] == [("several_regions",), ()]


@pytest.mark.parametrize(("seed", "strength"), [(1, 0.4), (3, 0.35), (5, 0.35)])
def test_fainter_print_that_overlaps_the_contact_is_left_out_and_flagged(seed, strength):
    truth, earlier = (
        render_contact_image(semi_major=6, semi_minor=5, seed=s, margin=5) for s in (seed, seed + 1)
    )
    fainter = 250 - strength * (250.0 - np.roll(earlier.pixels, 60, axis=0))
    found = measure_contact_image(np.minimum(truth.pixels, fainter), PPI_500)
    assert found.gross_area == pytest.approx(truth.gross_area, rel=0.08)  # 28 to 32 % with the earlier print
    assert found.flags == ("several_regions",)


def test_triangle_is_poor_ellipse():
    pixels = render_contact_image(semi_major=12, semi_minor=12, seed=3, pattern="arch", margin=2).pixels
    rows, columns = pixels.shape
    corners = np.array([[columns // 2, 60], [80, rows - 120], [columns - 80, rows - 120]])
    inside = cv2.fillPoly(np.zeros_like(pixels), [corners], 1) > 0
    found = measure_contact_image(np.where(inside, pixels, 250), PPI_500)
    assert "poor_ellipse" in found.flags


def test_faint_ink_low_contrast():
    truth = render_contact_image(seed=1, noise_std=0)
    faint = 128 + (truth.pixels - 128.0) * 0.12 + np.random.default_rng(0).normal(0, 10, truth.pixels.shape)
    assert "low_contrast" in measure_contact_image(faint, PPI_500).flags


@pytest.mark.parametrize(
    ("pixels", "words"),
    [
        (np.full((200, 200), 130.5), "no contact found"),
        (np.zeros((1, 1)), "too small"),
        (np.zeros((50, 50, 3)), "give the file, one channel, or the mean"),
        (np.zeros((5, 50, 50)), "one picture at a time"),
        (np.full((50, 50), "a"), "grey"),
        (np.full((50, 50), np.nan), "NaN"),
    ],
)
def test_unmeasurable_images_refused(pixels, words):
    with pytest.raises(ImageError, match=words):
        measure_contact_image(pixels, PPI_500)


@real
@pytest.mark.parametrize(
    ("finger", "hand", "corner"),
    [
        ("right_index", "right", (255, 165)),
        ("left_ring", "left", (115, 340)),
    ],
)
def test_finger_alone_equals_finger_in_slap(finger, hand, corner):
    alone = measured(LIVE / f"{finger}_500ppi.png")
    assert alone.flags == ()
    assert 0.35 < alone.ridge_area / alone.gross_area < 0.65
    assert 0.38 < alone.ridge_period < 0.5
    place = (alone.centroid[0] + corner[0], alone.centroid[1] + corner[1])
    among = measure_contact_image(load(LIVE / f"slap_{hand}_four_500ppi.png"), PPI_500, seed=place)
    assert among.gross_area == pytest.approx(alone.gross_area, rel=0.02)
    assert math.dist(among.centroid, place) < 4
    assert "several_regions" in among.flags
    cut = measure_contact_image(load(LIVE / "slap_left_four_500ppi.png"), PPI_500, seed=(800, 180))
    assert "touches_border" in cut.flags


def test_region_holds_the_pixels_whose_centre_is_inside():
    truth = render_contact_image(semi_major=4, semi_minor=3, orientation=0.4, irregularity=0.05, seed=4)
    found = measure_contact_image(truth.pixels, PPI_500)
    outline = np.ascontiguousarray(found.outline[:, ::-1], dtype=np.float32)
    rows, columns = truth.pixels.shape
    inside = [
        [cv2.pointPolygonTest(outline, (float(column), float(row)), False) > 0 for column in range(columns)]
        for row in range(rows)
    ]
    np.testing.assert_array_equal(found.region, inside)


def test_levels_under_a_mask_thinner_than_a_pixel_of_the_copy():
    mask = np.eye(300, dtype=bool)
    pixels = cv2.resize(render_contact_image(seed=1).pixels, (300, 300))
    prepared = prepare_contact_image(pixels, PPI_500, mask=mask, ridge_period=0.6)
    counts, edges = prepared.level_histogram()
    assert counts.sum() > 0
    assert edges[0] < edges[-1]
