"""
Ink print on a card
===================

An ink print with a form's lines and text, and a white border that is not straight (NIST MINEX, public
domain). The flags say what may be wrong; a flagged contact is not pooled before a person has looked at it.
See :doc:`the real print </gallery/measurements/real_print>` for where the file comes from.
"""

import os
from pathlib import Path

import fingerpad as fp

path = Path(os.environ.get("FINGERPAD_PRINTS", "")) / "nist_minex_ink" / "a001_03p.pgm"
if path.exists():
    image = fp.measure_contact_image(path, fp.Scale.of_ppi(500))
    print(image.summary())
    drawing = fp.show(image)
