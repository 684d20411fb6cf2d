"""
Real print from a live-scan device
==================================

A right index finger on a live-scan device, 500 ppi, from the test data of the NIST Biometric Image Software
(public domain). Green: the edge of the contact; orange: the ellipse of equal area and second moments. Real
prints are not distributed with fingerpad: `FINGERPAD_PRINTS` names the folder where they are.
"""

import os
from pathlib import Path

import fingerpad as fp

path = Path(os.environ.get("FINGERPAD_PRINTS", "")) / "nist_nbis_livescan_slaps" / "right_index_500ppi.png"
if path.exists():
    image = fp.measure_contact_image(path, fp.Scale.of_ppi(500))
    print(image.summary())
    drawing = fp.show(image)
