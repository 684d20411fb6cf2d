"""The whole manifest."""

from collections.abc import Iterable, Iterator
from typing import Annotated, Literal

from pydantic import Field

from fingerpad.study.manifest.contacts import ContactSequence, Observation
from fingerpad.study.manifest.curves import Curve
from fingerpad.study.manifest.fingers import Finger
from fingerpad.study.manifest.scales import CoinScale, OwnScale, ScaleKey, is_exact
from fingerpad.study.manifest.tables import AngleStd, ManifestModel, Name, RelativeStd


class Uncertainty(ManifestModel):
    """Standard uncertainties common to all observations."""

    wedge_angle_deg_std: AngleStd = 0.0
    roll_angle_deg_std: AngleStd = 0.0
    load_relative_std: RelativeStd = 0.0
    poisson_ratio_std: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    method: Literal["first_order", "monte_carlo"] = "first_order"


class Study(ManifestModel):
    """The whole manifest."""

    title: str
    description: str = ""
    poisson_ratio: Annotated[float, Field(gt=-1, le=0.5)] = 0.5
    uncertainty: Uncertainty = Uncertainty()
    scales: dict[Name, OwnScale] = Field(default={})
    fingers: Annotated[list[Finger], Field(min_length=1)]
    observations: list[Observation] = Field(default=[])
    observations_csv: str | None = None
    sequences: list[ContactSequence] = Field(default=[])
    curves: list[Curve] = Field(default=[])

    def named_files(self) -> Iterator[tuple[str, str]]:
        """Yield the place in the manifest and the name of every file that the study uses."""
        if self.observations_csv is not None:
            yield "observations_csv", self.observations_csv
        for name, scale in self.scales.items():
            yield from _coin_of(f"scales.{name}", scale)
        for place, keys, tables in self._tables_with_files():
            for index, table in enumerate(tables):
                for key in keys:
                    if (name := getattr(table, key)) is not None:
                        yield f"{place}[{index}].{key}", name
                yield from _coin_of(f"{place}[{index}].scale", getattr(table, "scale", None))

    def named_scales(self) -> Iterator[tuple[str, str]]:
        """Yield the place in the manifest and the name of every use of a scale by its name."""
        for place, _, tables in self._tables_with_files():
            for index, table in enumerate(tables):
                if isinstance(name := getattr(table, "scale", None), str):
                    yield f"{place}[{index}].scale", name

    def taken_as_exact(self) -> list[str]:
        """Name what results take as exact, since the manifest gives no uncertainty of it."""
        common = self.uncertainty
        stds = {"the wedge angle": common.wedge_angle_deg_std, "the load": common.load_relative_std}
        used = dict.fromkeys(name for _, name in self.named_scales())
        tables = [table for _, _, tables in self._tables_with_files() for table in tables]
        own = [scale for table in tables if isinstance(scale := getattr(table, "scale", None), ManifestModel)]
        return [
            *(words for words, std in stds.items() if not std),
            *(f"the scale {name}" for name in used if is_exact(self.scales[name])),
            *(["scales of single pictures"] if any(map(is_exact, own)) else []),
        ]

    def _tables_with_files(self) -> Iterator[tuple[str, tuple[str, ...], Iterable[ManifestModel]]]:
        """Yield each list of tables with its place and the keys that name files."""
        for index, finger in enumerate(self.fingers):
            yield f"fingers[{index}].photographs", ("outline", "file"), finger.photographs
        yield "observations", ("file", "background"), self.observations
        yield "sequences", ("file", "force", "times", "background"), self.sequences
        yield "curves", ("file",), self.curves


def _coin_of(place: str, scale: ScaleKey | None) -> Iterator[tuple[str, str]]:
    if isinstance(scale, CoinScale):
        yield f"{place}.coin", scale.coin
