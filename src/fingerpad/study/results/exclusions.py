"""Which contacts count in pooled results, and which flags keep one out of them."""

from typing import Final

from fingerpad.flags import FLAGS
from fingerpad.study.manifest import Contact
from fingerpad.study.measuring.measure import Measurement

# The picture does not show all of a contact at a known scale: nothing that a person says of it helps.
NEVER_POOLED: Final = frozenset(flag.code for flag in FLAGS["contact"].values() if flag.excludes == "pooling")
# What was measured may be a part of the contact, or more than it: a person who has looked can tell.
POOLED_IF_REVIEWED: Final = frozenset(
    flag.code for flag in FLAGS["contact"].values() if flag.excludes == "pooling unless reviewed"
)
# The ridge area is an upper bound; area and ellipse of the contact are no less sure.
RIDGES_MERGE: Final = "ridges_merge"
# A range note: with a pad of no finger's size, no radius is one.
IMPLAUSIBLE_SIZE: Final = "implausible_size"
_REVIEWED: Final = frozenset(("accepted", "corrected"))


def excluding_flags(contact: Contact, measured: Measurement, *, plausible: bool = True) -> frozenset[str]:
    """Return the flags of a measured contact, and the range note, that keep it out of pooled results.

    Parameters
    ----------
    contact : Contact
        Its table of the manifest. A seed, mask or region of interest says which of several patches is meant.
    measured : Measurement
        What was measured of it, and its manual correction.
    plausible : bool, optional
        Whether its finger's semi-axes are those of a finger pad.

    Examples
    --------
    >>> from fingerpad.study.manifest import Observation
    >>> where = {"name": "a", "finger": "index", "wedge_angle_deg": 30, "load_N": 1}
    >>> contact = Observation(**where, ellipse_mm={"semi_major": 6, "semi_minor": 5, "std": 0.1})
    >>> sorted(excluding_flags(contact, Measurement(flags=("poor_ellipse", "coin_shadow"))))
    ['poor_ellipse']
    >>> excluding_flags(contact, Measurement(flags=("poor_ellipse",), reviewed="accepted"))
    frozenset()
    >>> sorted(excluding_flags(contact, Measurement(), plausible=False))
    ['implausible_size']
    """
    excluding = NEVER_POOLED
    if measured.reviewed not in _REVIEWED:
        chosen = any((contact.seed_px, contact.mask_px, contact.region_of_interest_px))
        excluding |= POOLED_IF_REVIEWED - ({"several_regions"} if chosen else set())
    return excluding.intersection(measured.flags) | (set() if plausible else {IMPLAUSIBLE_SIZE})


def is_pooled(measured: Measurement, excluding: frozenset[str]) -> bool:
    """Return whether a contact counts in pooled results: as corrected manually, or else by its flags.

    Parameters
    ----------
    measured : Measurement
        What was measured of it, and its manual correction. A failed or rejected one never counts.
    excluding : frozenset of str
        Its `excluding_flags`.

    Examples
    --------
    >>> faint = frozenset({"low_contrast"})
    >>> is_pooled(Measurement(), faint), is_pooled(Measurement(pooling=True), faint)
    (False, True)
    """
    if measured.reason is not None or measured.rejected is not None:
        return False
    return measured.counts and not excluding if measured.pooling is None else measured.pooling
