"""The study manifest: a TOML file that says what was observed, and where the pictures and curves lie."""

import csv
import difflib
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from fingerpad.exceptions import ManifestError

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
# Names become file names: letters, digits and . _ + - only.
Name = Annotated[str, Field(pattern=r"^\w[\w.+-]*$", max_length=80)]
Direction = Literal["along", "across"]


class _Table(BaseModel):
    """A table of the manifest: no key that is not known, no value that changes."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class SemiAxes(_Table):
    """Semi-axes of a finger pad or their standard uncertainties, mm."""

    palmar: Positive
    distal: Positive
    radial_ulnar: Positive


class Photograph(_Table):
    """Outline points of one face of a finger."""

    face: Literal["palmar", "distal", "radial", "ulnar"]
    outline: str
    synthetic: bool = False


class Finger(_Table):
    """A finger, with its semi-axes given or to be fitted to the outlines of its photographs."""

    name: Name
    semi_axes_mm: SemiAxes | None = None
    semi_axes_std_mm: SemiAxes | None = None
    photographs: list[Photograph] = []
    pad_thickness_mm: Positive | None = None
    synthetic: bool = False

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.semi_axes_mm is None) == (not self.photographs):
            raise ValueError("give either semi_axes_mm or photographs, one of the two")
        if (self.semi_axes_mm is None) != (self.semi_axes_std_mm is None):
            raise ValueError("semi_axes_mm and semi_axes_std_mm belong together")
        return self


class ContactEllipse(_Table):
    """Semi-axes of a contact ellipse measured elsewhere, mm."""

    semi_major: Positive
    semi_minor: Positive
    std: Positive
    long_axis: Direction | None = None

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.semi_minor > self.semi_major:
            raise ValueError(
                f"semi_minor {self.semi_minor:g} must not exceed semi_major {self.semi_major:g}; swap them"
            )
        return self


class Observation(_Table):
    """One contact at one load: a contact image with its scale, or an ellipse measured elsewhere."""

    name: Name
    finger: str
    wedge_angle_deg: Annotated[float, Field(ge=0, le=90)]
    roll_angle_deg: Finite = 0.0
    load_N: Positive  # noqa: N815 (the unit's own letter)
    image: str | None = None
    background: str | None = None
    ppi: Positive | None = None
    mm_per_px: Positive | None = None
    scale_relative_std: NonNegative = 0.0
    finger_axis_deg: Finite = 0.0
    dark_on_light: bool | None = None
    seed_px: tuple[Finite, Finite] | None = None
    ellipse_mm: ContactEllipse | None = None
    synthetic: bool = False

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.image is None) == (self.ellipse_mm is None):
            raise ValueError("give either image or ellipse_mm, one of the two")
        if self.image is not None and (self.ppi is None) == (self.mm_per_px is None):
            raise ValueError("an image needs its scale: give either ppi or mm_per_px")
        return self


class Curve(_Table):
    """Loading data of one finger at one wedge angle: a curve, or the radius R_g found from one elsewhere."""

    finger: str
    wedge_angle_deg: Annotated[float, Field(ge=0, le=90)]
    file: str | None = None
    columns: dict[Literal["force", "displacement", "area"], str] = {}
    effective_radius_mm: Positive | None = None
    effective_radius_std_mm: Positive | None = None
    synthetic: bool = False

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.file is None) == (self.effective_radius_mm is None):
            raise ValueError("give either file or effective_radius_mm, one of the two")
        return self


class Uncertainty(_Table):
    """Standard uncertainties common to all observations."""

    wedge_angle_std_deg: NonNegative = 0.0
    roll_angle_std_deg: NonNegative = 0.0
    load_relative_std: NonNegative = 0.0


class Study(_Table):
    """The whole manifest."""

    title: str
    description: str = ""
    poisson_ratio: Annotated[float, Field(gt=-1, le=0.5)] = 0.5
    uncertainty: Uncertainty = Uncertainty()
    fingers: Annotated[list[Finger], Field(min_length=1)]
    observations: list[Observation] = []
    observations_csv: str | None = None
    curves: list[Curve] = []

    def named_files(self) -> Iterable[tuple[str, str]]:
        """Yield the place in the manifest and the name of every file that the study uses."""
        if self.observations_csv is not None:
            yield "observations_csv", self.observations_csv
        for i, finger in enumerate(self.fingers):
            for j, photograph in enumerate(finger.photographs):
                yield f"fingers[{i}].photographs[{j}].outline", photograph.outline
        for i, row in enumerate(self.observations):
            for key, name in (("image", row.image), ("background", row.background)):
                if name is not None:
                    yield f"observations[{i}].{key}", name
        for i, curve in enumerate(self.curves):
            if curve.file is not None:
                yield f"curves[{i}].file", curve.file


_TABLES = (Study, Uncertainty, Curve, Observation, ContactEllipse, Finger, Photograph, SemiAxes)
_KEYS = tuple(key for table in _TABLES for key in table.model_fields)
_ELLIPSE_COLUMNS = {
    "semi_major_mm": "semi_major",
    "semi_minor_mm": "semi_minor",
    "ellipse_std_mm": "std",
    "long_axis": "long_axis",
}
Model = TypeVar("Model", bound=BaseModel)


def read_study(path: Path) -> Study:
    """Read and check a manifest; rows of ``observations_csv`` are appended to its observations.

    Everything is checked before any work: keys, values, references between tables, and that every file named
    exists inside the study folder.

    Parameters
    ----------
    path : Path
        The TOML file. File names in it are relative to its folder.

    Raises
    ------
    ManifestError
        Naming the file, and for each fault its key, what was found and what was expected.
    """
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ManifestError(
            f"{path}: no such file; `fingerpad init DIR` writes a manifest to start from"
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise ManifestError(f"{path}: cannot be read ({error})") from error
    except tomllib.TOMLDecodeError as error:
        raise ManifestError(f"{path}: not valid TOML: {error}") from error
    study = _validated(Study, content, path.name)
    if study.observations_csv is not None:
        rows = _read_rows(_inside(path.parent, study.observations_csv, path.name, "observations_csv"))
        study = study.model_copy(update={"observations": [*study.observations, *rows]})
    faults = [*_reference_faults(study), *_file_faults(study, path.parent)]
    if faults:
        raise ManifestError("\n".join(f"{path.name}: {fault}" for fault in faults))
    return study


def _validated(model: type[Model], content: Mapping[str, Any], where: str) -> Model:
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise ManifestError("\n".join(f"{where}: {fault}" for fault in _value_faults(error))) from None


def _value_faults(error: ValidationError) -> Iterable[str]:
    """Say for each fault where it is, what is expected, and what was found."""
    for fault in error.errors():
        place = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in fault["loc"]).lstrip(
            "."
        )
        key = str(fault["loc"][-1]) if fault["loc"] else ""
        message = fault["msg"].removeprefix("Value error, ").replace("Input should be", "expected")
        if fault["type"] == "extra_forbidden":
            close = difflib.get_close_matches(key, _KEYS, n=1)
            yield f"{place}: unknown key" + (f"; did you mean {close[0]!r}?" if close else "")
        elif fault["type"] == "missing":
            yield f"{place}: required, but missing"
        elif isinstance(fault["input"], str | int | float | bool):
            yield f"{place}: {message}, found {fault['input']!r}"
        else:
            yield f"{place}: {message}" if place else message


def _read_rows(path: Path) -> list[Observation]:
    """Read observations from a spreadsheet's CSV: its headers are the keys of an observation."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.DictReader(file)
            return [_row(row, f"{path.name}, line {reader.line_num}") for row in reader]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ManifestError(f"{path.name}: cannot be read as CSV ({error})") from error


def _row(cells: Mapping[str, Any], where: str) -> Observation:
    if None in cells:
        raise ManifestError(f"{where}: more cells than the header has columns")
    content: dict[str, Any] = {
        key.strip(): cell.strip() for key, cell in cells.items() if cell and cell.strip()
    }
    ellipse = {key: content.pop(column) for column, key in _ELLIPSE_COLUMNS.items() if column in content}
    if ellipse:
        content["ellipse_mm"] = ellipse
    return _validated(Observation, content, where)


def _reference_faults(study: Study) -> Iterable[str]:
    fingers = [finger.name for finger in study.fingers]
    for kind, names in (("fingers", fingers), ("observations", [row.name for row in study.observations])):
        for name in sorted({name for name in names if names.count(name) > 1}):
            yield f"{kind}: the name {name!r} is given {names.count(name)} times; names must differ"
    used = [(f"observations[{index}]", row.finger) for index, row in enumerate(study.observations)]
    used += [(f"curves[{index}]", curve.finger) for index, curve in enumerate(study.curves)]
    for place, name in used:
        if name not in fingers:
            yield f"{place}.finger: no finger is named {name!r}; there is {', '.join(fingers)}"


def _file_faults(study: Study, folder: Path) -> Iterable[str]:
    for place, name in study.named_files():
        try:
            _inside(folder, name, "", place)
        except ManifestError as error:
            yield str(error).removeprefix(": ")


def _inside(folder: Path, name: str, where: str, place: str) -> Path:
    """Return the path of a file of the study, which must exist inside its folder."""
    path = folder / name
    if not path.resolve().is_relative_to(folder.resolve()):
        raise ManifestError(f"{where}: {place}: {name!r} leaves the study folder; copy the file into it")
    if not path.is_file():
        raise ManifestError(f"{where}: {place}: no file {name!r} in the study folder")
    return path
