"""Images of one finger and one device, to which a correction of one of them may apply too."""

from typing import Final

from fingerpad.study.corrections.changes import ContactCorrection
from fingerpad.study.manifest import Study

# How an image is measured. What was drawn, and the place of a contact, belong to one image alone.
SHARED_SETTINGS: Final = ("dark_on_light", "threshold", "region_of_interest_px", "mask_px")


def similar_images(item: str, study: Study) -> list[str]:
    """Return the other contact images of the same finger with the same scale, as of one device.

    Parameters
    ----------
    item : str
        An observation.
    study : Study
        The manifest.

    Examples
    --------
    >>> def image(name, finger, ppi):
    ...     place = {"finger": finger, "wedge_angle_deg": 30, "load_N": 1}
    ...     return {"name": name, "file": f"{name}.png", "scale": {"ppi": ppi}, **place}
    >>> images = [image("a", "f", 500), image("b", "f", 500), image("c", "f", 1000), image("d", "g", 500)]
    >>> axes = {"palmar": 8, "distal": 14, "radial_ulnar": 12}
    >>> known = {"semi_axes_mm": axes, "semi_axes_mm_std": dict.fromkeys(axes, 0.1)}
    >>> fingers = [{"name": "f", **known}, {"name": "g", **known}]
    >>> study = Study.model_validate({"title": "t", "fingers": fingers, "observations": images})
    >>> similar_images("a", study)
    ['b']
    """
    one = next((each for each in study.observations if each.name == item and each.file), None)
    if one is None:
        return []
    return [
        each.name
        for each in study.observations
        if each.file and each.name != item and (each.finger, each.scale) == (one.finger, one.scale)
    ]


def with_settings_of(source: ContactCorrection, target: ContactCorrection) -> ContactCorrection:
    """Return a correction with another one's settings where that has them, without a verdict.

    Parameters
    ----------
    source : ContactCorrection
        Whose settings are taken.
    target : ContactCorrection
        Of the other image; what was drawn there stays.

    Examples
    --------
    >>> source = ContactCorrection(threshold=60.0, seed_px=[5.0, 5.0], accepted=True)
    >>> with_settings_of(source, ContactCorrection(dark_on_light=True, rejected="smeared")).as_json()
    {'dark_on_light': True, 'threshold': 60.0}
    """
    settings = {name: value for name in SHARED_SETTINGS if (value := getattr(source, name)) is not None}
    return target.model_copy(update={**settings, "accepted": False, "rejected": None})
