"""What the flags of contact images, their frames and their scales mean."""

from collections.abc import Mapping
from typing import Final

FLAG_WORDS: Final[Mapping[str, str]] = {
    "touches_border": "the contact is cut by the edge of the picture",
    "low_contrast": "the contact has little contrast with the background",
    "several_regions": "there are other patches beside the one measured",
    "poor_ellipse": "the contact is not well described by an ellipse",
    "cut_by_mask": "the contact is cut by the mask or region of interest",
    "scale_doubtful": "the ridge period is not that of a finger: check the scale",
    "not_a_contact_image": "no finger ridges (0.3–0.7 mm apart) fill it: check picture and scale",
    "ridges_merge": "sweat or ink may have joined the ridges: their area is an upper bound",
    "printed_marks": "letters or marks darker than ridges lie in the contact and are counted in its areas",
    "edited_manually": "the contact was drawn manually, in part or as a whole",
    "interpolated": "the ellipse is interpolated between two key frames",
    "coin_shadow": "a shadow beside the coin may make the scale too small",
    "grid_tilted": "the scale differs with place and direction: rectify the pictures by their grid",
    "grid_bent": "the grid is not flat, or the lens bends lines: the scale differs with place",
    "no_time": "the frame has no time",
    "no_force": "the force signal does not cover the frame",
}
