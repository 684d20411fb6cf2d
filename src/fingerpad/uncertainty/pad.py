"""The finger pad as one function of arrays: what goes in, what comes out, with uncertainty.

Any way of propagating uncertainty can take `pad_model`, which broadcasts over its leading axes.
"""

from collections.abc import Mapping
from dataclasses import fields
from typing import Final

import numpy as np

from fingerpad._arrays import FloatArray
from fingerpad.contact.pad import PadContact, pad_contact_kernel
from fingerpad.geometry.ellipsoid import principal_radii_kernel
from fingerpad.geometry.placement import platen_normal_kernel

# The contact ellipse enters by its size √(ℓd ℓe) and its elongation ln(ℓd/ℓe), which stays differentiable
# where noise makes a near-circle's axes change places. The image scale is a factor on the size, one: it is
# an input by itself because all images that it calibrates share it.
PAD_INPUTS: Final = (
    "palmar",
    "distal",
    "radial_ulnar",
    "wedge_angle",
    "roll_angle",
    "poisson_ratio",
    "image_scale",
    "load",
    "contact_radius_ratio",
    "elongation",
)
PAD_OUTPUTS: Final = tuple(field.name for field in fields(PadContact))

# What an uncertainty budget tells apart: places in `PAD_INPUTS` by the name of the source.
PAD_SOURCES: Final[Mapping[str, tuple[int, ...]]] = {
    "semi-axes": (0, 1, 2),
    "wedge angle": (3,),
    "roll angle": (4,),
    "Poisson's ratio": (5,),
    "image scale": (6,),
    "load": (7,),
    "contact ellipse": (8, 9),
}


def pad_model(inputs: FloatArray) -> FloatArray:
    """Return the fields of `PadContact` along the last axis, from `PAD_INPUTS` along the last axis.

    Examples
    --------
    >>> import numpy as np
    >>> ellipse = np.sqrt(7.4 * 5.0), np.log(7.4 / 5.0)
    >>> inputs = np.array([7.9, 13.8, 11.8, np.radians(30), 0.0, 0.5, 1.0, 2.0, *ellipse])
    >>> outputs = pad_model(inputs)
    >>> round(float(outputs[PAD_OUTPUTS.index("mean_curvature_radius")]), 3)
    13.608
    """
    palmar, distal, radial_ulnar, wedge, roll, poisson, scale, load, size, elongation = np.moveaxis(
        inputs, -1, 0
    )
    half = np.exp(0.5 * elongation)
    contact = pad_contact_kernel(
        principal_radii_kernel(palmar, distal, radial_ulnar, normal=platen_normal_kernel(wedge, roll)),
        load=load,
        semi_major=scale * size * half,
        semi_minor=scale * size / half,
        poisson_ratio=poisson,
    )
    return np.stack([getattr(contact, name) for name in PAD_OUTPUTS], axis=-1)
