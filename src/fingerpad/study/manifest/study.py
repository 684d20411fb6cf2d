"""The whole manifest."""

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from fingerpad.study.manifest.contacts import ContactSequence, Observation
from fingerpad.study.manifest.curves import Curve
from fingerpad.study.manifest.fingers import Finger
from fingerpad.study.manifest.scales import OwnScale, ScaleKey, is_exact
from fingerpad.study.manifest.tables import AngleStd, ManifestModel, Name, Positive, RelativeStd

# A phrase inside a sentence.
Text = Annotated[str, Field(max_length=300)]


class Uncertainty(ManifestModel):
    """Standard uncertainties common to all observations."""

    # A finger's angle on a wedge is known like a joint's by a goniometer, to 2 to 5 degrees.
    wedge_angle_deg_std: AngleStd = 3.0
    """Standard uncertainty of wedge angles; 0 takes them as exact."""
    roll_angle_deg_std: AngleStd = 3.0
    """Standard uncertainty of roll angles; 0 takes them as exact."""
    load_relative_std: RelativeStd = 0.0
    """Relative standard uncertainty of loads."""
    poisson_ratio_std: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    """Standard uncertainty of Poisson's ratio."""
    method: Literal["first_order", "monte_carlo"] = "first_order"
    """How uncertainties are propagated."""


class Apparatus(ManifestModel):
    """What a methods section says of the experiment and no file shows, in the words to be printed."""

    imaging: Text = ""
    """How contact images were taken."""
    platen: Text = ""
    """What the finger pressed on."""
    force_sensor: Text = ""
    """What measured the force."""
    stage: Text = ""
    """What moved finger or platen."""
    scale_calibration: Text = ""
    """How the scale was found."""
    poisson_ratio_basis: Text = ""
    """Why Poisson's ratio is what it is."""
    thickness_basis: Text = ""
    """Where the thickness of the tissue comes from."""
    approach_mm_per_s: Positive | None = None
    """Speed of approach, mm/s."""
    dwell_s: Positive | None = None
    """Time held before the image was taken, s."""


class Study(ManifestModel):
    """The whole manifest."""

    model_config = ConfigDict(json_schema_extra={"required": ["title", "fingers"]})

    title: str
    """Title of the study."""
    description: str = ""
    """Whose fingers, which apparatus, which day."""
    poisson_ratio: Annotated[float, Field(gt=-1, le=0.5)] = 0.5
    """Poisson's ratio of the tissue."""
    uncertainty: Uncertainty = Uncertainty()
    """Standard uncertainties that all observations share."""
    apparatus: Apparatus = Apparatus()
    """What the methods section says of the experiment."""
    scales: dict[Name, OwnScale] = Field(default={})
    """Scales by name, for pictures that share one."""
    fingers: list[Finger] = Field(default=[])
    """The fingers."""
    observations: list[Observation] = Field(default=[])
    """Contacts, each at one load."""
    observations_csv: str | None = None
    """CSV file of observations, with the same keys as headers."""
    sequences: list[ContactSequence] = Field(default=[])
    """Image sequences of presses."""
    curves: list[Curve] = Field(default=[])
    """Loading curves."""

    def named_scales(self) -> Iterator[str]:
        """Yield the name of a scale for every use of it."""
        return (scale for scale in self.scales_in_use() if isinstance(scale, str))

    def scales_in_use(self) -> Iterator[ScaleKey]:
        """Yield the scale of each picture and sequence: a table, or the name of one."""
        for _, table in self.tables():
            for one in (table, *(inner for _, inner in table.tables())):
                if (scale := getattr(one, "scale", None)) is not None:
                    yield scale

    def assumed(self) -> list[str]:
        """Name the uncertainties that results assume, since the manifest does not state them."""
        common = self.uncertainty
        stds = {
            "wedge_angle_deg_std": f"the wedge angle to ± {common.wedge_angle_deg_std:g}°",
            "roll_angle_deg_std": f"the roll angle to ± {common.roll_angle_deg_std:g}°",
        }
        return [words for key, words in stds.items() if key not in common.model_fields_set]

    def taken_as_exact(self) -> list[str]:
        """Name what results take as exact, since the manifest gives no uncertainty of it."""
        common = self.uncertainty
        stds = {
            "the wedge angle": common.wedge_angle_deg_std,
            "the roll angle": common.roll_angle_deg_std,
            "the load": common.load_relative_std,
            "Poisson's ratio": common.poisson_ratio_std,
        }
        used = dict.fromkeys(self.named_scales())
        own = (scale for scale in self.scales_in_use() if isinstance(scale, ManifestModel))
        return [
            *(words for words, std in stds.items() if not std),
            *(
                f"the effective thickness of {finger.name}"
                for finger in self.fingers
                if finger.effective_thickness_mm is not None and finger.effective_thickness_mm_std is None
            ),
            *(
                f"the scale of the outlines of {finger.name}"
                for finger in self.fingers
                if any(
                    one.outline and one.scale is None and not one.outline_relative_std
                    for one in finger.photographs
                )
            ),
            *(
                f"R_g of {curve.finger} at {curve.wedge_angle_deg:g}°"
                for curve in self.curves
                if curve.loading_radius_mm is not None and not curve.loading_radius_mm_std
            ),
            *(
                ["the stage of loading curves (rigid)"]
                if any(curve.file and curve.stage_compliance_mm_per_N is None for curve in self.curves)
                else []
            ),
            *(f"the scale “{name}”" for name in used if is_exact(self.scales[name])),
            *(["scales of single pictures"] if any(map(is_exact, own)) else []),
        ]
