"""The finger pad as one function of arrays: what goes in, what comes out, with uncertainty.

Any way of propagating uncertainty can take `pad_model`, which broadcasts over its leading axes.
"""

from dataclasses import fields
from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.contact import PadContact, pad_contact
from fingerpad.geometry import Ellipsoid

# The first five belong to the finger on its wedge and are shared by all its observations there.
PAD_INPUTS: Final = (
    "palmar",
    "distal",
    "radial_ulnar",
    "wedge_angle",
    "roll_angle",
    "load",
    "semi_major",
    "semi_minor",
)
SHARED_INPUTS: Final = 5
PAD_OUTPUTS: Final = tuple(field.name for field in fields(PadContact))


def pad_model(inputs: FloatArray) -> FloatArray:
    """Return the fields of `PadContact` along the last axis, from `PAD_INPUTS` along the last axis.

    Examples
    --------
    >>> import numpy as np
    >>> inputs = np.array([7.9, 13.8, 11.8, np.radians(30), 0.0, 2.0, 7.4, 5.0])
    >>> outputs = pad_model(inputs)
    >>> round(float(outputs[PAD_OUTPUTS.index("mean_curvature_radius")]), 3)
    13.608
    """
    palmar, distal, radial_ulnar, wedge, roll, load, major, minor = np.moveaxis(inputs, -1, 0)
    contact = pad_contact(
        Ellipsoid(palmar=palmar, distal=distal, radial_ulnar=radial_ulnar),
        wedge_angle=wedge,
        roll_angle=roll,
        load=load,
        semi_major=major,
        semi_minor=minor,
    )
    return np.stack([getattr(contact, name) for name in PAD_OUTPUTS], axis=-1)
