"""Images, sequences and loading curves of known truth, all synthetic."""

from fingerpad.simulate._finger_shape import outline_points
from fingerpad.simulate.coin import SyntheticCoin, render_coin
from fingerpad.simulate.contact_image import SyntheticContactImage, render_contact_image
from fingerpad.simulate.finger import Backdrop, SyntheticFinger, render_finger
from fingerpad.simulate.loading_curve import simulate_loading_curve
from fingerpad.simulate.sequence import SyntheticSequence, render_sequence

__all__ = [
    "Backdrop",
    "SyntheticCoin",
    "SyntheticContactImage",
    "SyntheticFinger",
    "SyntheticSequence",
    "outline_points",
    "render_coin",
    "render_contact_image",
    "render_finger",
    "render_sequence",
    "simulate_loading_curve",
]
