"""Real prints whose forces are unknown: areas, flags, and what a person sees of the outline drawn over each.

They are no part of the repository; ``FINGERPAD_PRINTS`` names their folder. What the eye sees was written
down on 2026-11-27 in front of the overlays; they have to be looked at again when areas move.
"""

import os
import sys
from pathlib import Path
from typing import Final

import numpy as np

from benchmarks import ROOT
from benchmarks.tables import or_none, percent, table
from fingerpad.image import Scale, measure_contact_image, read_image

PRINTS: Final = {"nist_nbis_livescan_slaps": 500, "nist_minex_ink": 500, "nist_nbis_rolled_1000ppi": 1000}
GAMMAS: Final = (0.6, 1.8)
SEEN: Final = {
    "left_index_500ppi": "right; ends above the crease",
    "slap_left_four_500ppi": "right, of the ring finger",
    "slap_right_four_500ppi": "right, of the ring finger",
    "a001_03p": "form text taken in at the tip",
    "a001_04p": "form text and a line taken in at the tip",
    "a001_05p": "right; the scanned card ends at the print's edge",
    "a001_06p": "cut; reaches to a pen line on the left",
    "b001_04p": "right as far as the card shows it: cut at the tip",
    "b001_08p": "cut at the tip, form text taken in, patchy below",
    "card0001_01_1000ppi": "fills the frame",
    "card0001_03_1000ppi": "the tip alone, cut at a slant below the crease",
}


def report() -> None:
    """Print what is measured of each print."""
    folder = Path(os.environ.get("FINGERPAD_PRINTS", ROOT.parent / "shared" / "data"))
    if not any((folder / name).is_dir() for name in PRINTS):
        sys.exit(f"{folder} has no folder {', '.join(PRINTS)}: FINGERPAD_PRINTS names where they lie")
    rows: list[tuple[str, ...]] = []
    curved: list[tuple[str, ...]] = []
    for name, ppi in PRINTS.items():
        for path in sorted((folder / name).glob("*.p[ng][mg]")):
            seen, print_ = SEEN.get(path.stem, "right"), path.stem.replace("_", " ")
            picture, scale = read_image(path), Scale.of_ppi(ppi)
            if (found := or_none(measure_contact_image, picture, scale)) is None:
                rows.append((print_, "–", "–", "refused", seen))
                continue
            flags = ", ".join(f"`{flag}`" for flag in found.flags) or "–"
            rows.append((print_, f"{found.gross_area:.1f}", f"{found.gross_area_std:.1f}", flags, seen))
            moved = []
            plain, grey = measure_contact_image(picture.pixels, scale), picture.pixels.astype(float) / 255
            for gamma in GAMMAS:
                bent = or_none(measure_contact_image, np.rint(255 * grey**gamma).astype(np.uint8), scale)
                moved += [
                    percent(getattr(bent, area) / getattr(plain, area) - 1, "+") if bent else "refused"
                    for area in ("gross_area", "ridge_area")
                ]
            curved.append((print_, *moved, percent(plain.ridge_area_std / plain.ridge_area)))
    table(("print", "gross area, mm²", "±", "flags", "by eye"), rows)
    of_gamma = (f"{area} area, gamma {gamma:g}" for gamma in GAMMAS for area in ("gross", "ridge"))
    table(("print", *of_gamma, "± of the ridge area"), curved, "Change of areas by a tone curve")
