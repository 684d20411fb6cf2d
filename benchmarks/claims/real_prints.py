"""Real prints whose forces are unknown: areas, flags, and what a person sees of the outline drawn over each.

They are no part of the repository; ``FINGERPAD_PRINTS`` names their folder. The last column was written down
by looking at the overlays, and is right for the outlines of the commit below.
"""

import os
from pathlib import Path
from typing import Final

from benchmarks import ROOT
from benchmarks.tables import table
from fingerpad.exceptions import ImageError
from fingerpad.image import Scale, measure_contact_image, read_image

PRINTS: Final = {
    "nist_nbis_livescan_slaps": ("live-scan", 500, "right; one ends above the crease"),
    "nist_minex_ink": ("ink", 500, "right, or cut by the card, or with form text taken in: flagged"),
    "nist_nbis_rolled_1000ppi": ("rolled", 1000, "no contact of one load; fills the frame"),
}


def report() -> None:
    """Print what is measured of each print."""
    folder = Path(os.environ.get("FINGERPAD_PRINTS", ROOT.parent / "shared" / "data"))
    rows = []
    for name, (device, ppi, seen) in PRINTS.items():
        for path in sorted((folder / name).glob("*.p[ng][mg]")):
            try:
                found = measure_contact_image(read_image(path), Scale.of_ppi(ppi))
            except ImageError as error:
                rows.append(
                    (f"{device}, {path.stem}", "refused", "–", str(error).split(":")[0][:60], "right")
                )
                continue
            flags = ", ".join(f"`{flag}`" for flag in found.flags) or "–"
            area, std = f"{found.gross_area:.1f}", f"{found.gross_area_std:.1f}"
            rows.append((f"{device}, {path.stem}", area, std, flags, seen))
    table(("print", "gross area, mm²", "±", "flags", "by eye"), rows)
