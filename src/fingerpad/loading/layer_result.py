"""What one loading curve says of the tissue over bone: thickness, modulus and the evidence for a layer."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Final, Self

from fingerpad._json import plain
from fingerpad._records import Recorded
from fingerpad.estimate import Estimate, estimates_record
from fingerpad.units import KPA_PER_MPA

# Flag of a thickness that no finger has.
THICKER_THAN_FINGER: Final = "thicker_than_finger"
# Akaike weight from which on models explain a curve as well as others.
EXPLAINS: Final = 0.05


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LayerThicknessFit(Recorded):
    """Thickness and modulus of a layer of tissue over bone that explain one loading curve.

    Attributes
    ----------
    thickness : Estimate
        Effective thickness t, mm. The upper end of its interval and its value are infinite where the curve
        says only how thick the tissue is at least.
    youngs_modulus : Estimate
        E of the tissue, MPa.
    contact_offset : Estimate
        Displacement at first contact, mm. Hertz theory finds it later, where there is bone.
    radius : Estimate
        1/H of the pad, mm: the given one, improved by the curve.
    contact_over_thickness : float
        a/t at the largest area, by the best thickness; 0 on a half-space.
    correlation : float
        Of the errors of 1/t and E.
    aicc : mapping of str to float
        Corrected Akaike criterion of the pad on a ``layer`` and on a ``half_space``, and of the
        ``paraboloid`` of Hertz theory on a half-space, its radius as uncertain as the pad's; each also
        ``_load_dependent`` (a modulus that grows with load) and ``_area_offset`` (areas with a zero of their
        own), under one noise.
    weights : mapping of str to float
        Akaike weights of the same models; their sum is 1.
    notes : mapping of str to str
        What a flag means for this curve.
    flags : tuple of str
        Doubts.

    Examples
    --------
    >>> from fingerpad.geometry import Paraboloid
    >>> from fingerpad.loading import fit_layer_thickness
    >>> from fingerpad.simulate import simulate_loading_curve
    >>> curve = simulate_loading_curve(points=60, force_std=0.005, area_std=0.5, seed=1, load_coefficient=0)
    >>> deep = fit_layer_thickness(curve, placement=Paraboloid(15.0, 15.0), radius_std=0.3)
    >>> deep.thickness.upper, round(sum(deep.weights.values()), 6)
    (inf, 1.0)
    """

    _title: ClassVar[str] = "Layer of tissue over bone"

    thickness: Estimate
    youngs_modulus: Estimate
    contact_offset: Estimate
    radius: Estimate
    contact_over_thickness: float
    correlation: float
    aicc: Mapping[str, float]
    weights: Mapping[str, float]
    notes: Mapping[str, str]
    flags: tuple[str, ...]

    @property
    def preferred_model(self) -> str:
        """That of the least AICc; empty where nothing was fitted."""
        return min(self.aicc, key=self.aicc.__getitem__, default="")

    @property
    def layer_weight(self) -> float:
        """Akaike weight of all models with a layer, against those of a half-space."""
        return weight_of("layer", self.weights)

    @property
    def hertz_weight(self) -> float:
        """Akaike weight of all models of Hertz theory: of a paraboloid on a half-space."""
        return weight_of("paraboloid", self.weights)

    @property
    def conclusion(self) -> str:
        """Thickness and modulus with their intervals and the evidence, or why they are unknown, as text."""
        t, modulus = self.thickness, self.youngs_modulus.times(KPA_PER_MPA)
        if not t.known:
            return f"thickness of the tissue undetermined: {t.reason}"
        if THICKER_THAN_FINGER in self.notes:
            said = (
                f"this curve tells no thickness of the tissue: the best fit, {t.value:.3g} mm "
                f"(95 %: {t.lower:.3g} to {t.upper:.3g} mm), is thicker than a finger"
            )
        elif t.upper < math.inf and t.lower > 0:
            said = f"tissue {t.value:.3g} mm thick (95 %: {t.lower:.3g} to {t.upper:.3g} mm)"
        elif t.lower > 0:
            said = f"tissue thicker than {t.lower:.3g} mm (95 %)"
        else:
            said = f"tissue thinner than {t.upper:.3g} mm (95 %)"
        if modulus.known:
            said += f", E = {modulus.value:.3g} kPa (95 %: {modulus.lower:.3g} to {modulus.upper:.3g} kPa)"
        if self.contact_offset.known:
            said += f", contact at {self.contact_offset} mm"
        weight = self.layer_weight
        certain = "above 0.999" if weight > 0.999 else "below 0.001" if weight < 0.001 else f"{weight:.3f}"
        return f"{said}; Akaike weight of a layer against a half-space {certain}"

    @property
    def advice(self) -> str:
        """Which modulus to believe, that of the layer or that of Hertz theory, and why, as text."""
        t = self.thickness
        if not (t.known and self.youngs_modulus.known):
            if self.hertz_weight > self.layer_weight:
                return (
                    "believe E and the place of contact of Hertz theory: nothing in the curve speaks for bone"
                )
            return (
                "E of Hertz theory is that of a half-space: bone, which the curve neither shows nor "
                "excludes, would make it too high"
            )
        if t.upper < math.inf and THICKER_THAN_FINGER not in self.notes:
            if self.layer_weight > 1 - EXPLAINS:
                return (
                    "believe the layer's E and place of contact, not those of Hertz theory, which takes the "
                    "tissue for a half-space: bone makes its E too high and its contact late"
                )
            return (
                "believe the layer's E, whose uncertainty holds what is not known of the bone; that of Hertz "
                "theory is right only if there is none"
            )
        return (
            "believe the layer's E: it allows for the pad's form, which Hertz theory takes for a paraboloid, "
            "and for bone, of which the curve shows none"
        )

    @classmethod
    def undetermined(cls, reason: str, flags: tuple[str, ...] = ()) -> Self:
        """Return a result that nothing could be fitted for.

        Parameters
        ----------
        reason : str
            Why.
        flags : tuple of str
            Doubts about the curve.

        Returns
        -------
        LayerThicknessFit
            With that reason for every quantity.

        Examples
        --------
        >>> LayerThicknessFit.undetermined("no contact area").conclusion
        'thickness of the tissue undetermined: no contact area'
        """
        unknown = Estimate.unknown(reason)
        return cls(
            **dict.fromkeys(("thickness", "youngs_modulus", "contact_offset", "radius"), unknown),
            contact_over_thickness=0.0,
            correlation=0.0,
            aicc={},
            weights={},
            notes={},
            flags=flags,
        )

    def as_record(self) -> dict[str, Any]:
        """Return the numbers by names that end in units.

        Returns
        -------
        dict
            Each with ``_std`` and ``_ci95``; None where unknown, and for an end that is infinite.
        """
        record = estimates_record(
            {
                "thickness_mm": self.thickness,
                "youngs_modulus_kpa": self.youngs_modulus.times(KPA_PER_MPA),
                "contact_offset_mm": self.contact_offset,
                "radius_mm": self.radius,
            }
        )
        return {
            **plain(record),
            "contact_over_thickness": self.contact_over_thickness,
            "correlation": plain(self.correlation),
            "preferred_model": self.preferred_model or None,
            "layer_weight": self.layer_weight if self.weights else None,
            "hertz_weight": self.hertz_weight if self.weights else None,
            "advice": self.advice,
            "aicc": dict(self.aicc),
            "weights": dict(self.weights),
            "notes": dict(self.notes),
            "flags": list(self.flags),
        }


def weight_of(body: str, weights: Mapping[str, float]) -> float:
    """Return the Akaike weight of all models of what is pressed, a ``layer`` or ``paraboloid``, say."""
    return sum(weight for name, weight in weights.items() if name.startswith(body))
