"""The finger pad as one function of arrays: what goes in, what comes out, with uncertainty.

Any way of propagating uncertainty can take `pad_model`, which broadcasts over its leading axes.
"""

from dataclasses import fields
from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.contact import PadContact, pad_contact
from fingerpad.geometry import Ellipsoid

# The contact ellipse enters by its size √(ℓd ℓe) and its elongation ln(ℓd/ℓe), which stays differentiable
# where noise makes a near-circle's axes change places. The first five inputs belong to the finger on its
# wedge and are shared by all its observations there.
PAD_INPUTS: Final = (
    "palmar",
    "distal",
    "radial_ulnar",
    "wedge_angle",
    "roll_angle",
    "load",
    "contact_size",
    "elongation",
)
SHARED_INPUTS: Final = 5
PAD_OUTPUTS: Final = tuple(field.name for field in fields(PadContact))


def pad_model(inputs: FloatArray) -> FloatArray:
    """Return the fields of `PadContact` along the last axis, from `PAD_INPUTS` along the last axis.

    Examples
    --------
    >>> import numpy as np
    >>> ellipse = np.sqrt(7.4 * 5.0), np.log(7.4 / 5.0)
    >>> inputs = np.array([7.9, 13.8, 11.8, np.radians(30), 0.0, 2.0, *ellipse])
    >>> outputs = pad_model(inputs)
    >>> round(float(outputs[PAD_OUTPUTS.index("mean_curvature_radius")]), 3)
    13.608
    """
    palmar, distal, radial_ulnar, wedge, roll, load, size, elongation = np.moveaxis(inputs, -1, 0)
    contact = pad_contact(
        Ellipsoid(palmar=palmar, distal=distal, radial_ulnar=radial_ulnar),
        wedge_angle=wedge,
        roll_angle=roll,
        load=load,
        semi_major=size * np.exp(0.5 * elongation),
        semi_minor=size * np.exp(-0.5 * elongation),
    )
    return np.stack([getattr(contact, name) for name in PAD_OUTPUTS], axis=-1)
