"""The study manifest: a TOML file that says what was observed, and where the pictures and curves lie."""

import csv
import difflib
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self, TypeVar

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

from fingerpad.exceptions import ManifestError

# Wide bounds that only a slip of units or of the keyboard crosses.
Length = Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False)]
LengthStd = Annotated[float, Field(ge=1e-9, le=1000, allow_inf_nan=False)]
Load = Annotated[float, Field(gt=0, le=1e4, allow_inf_nan=False)]
RelativeStd = Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False)]
AngleStd = Annotated[float, Field(ge=0, le=90, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
# Names become file names: letters, digits and . _ + - only.
Name = Annotated[str, Field(pattern=r"^\w[\w.+-]*$", max_length=60)]
Ppi = Annotated[float, Field(ge=20, le=1e5)]
MmPerPx = Annotated[float, Field(ge=1e-4, le=1)]
Corner = Annotated[list[Finite], Field(min_length=2, max_length=2)]
Direction = Literal["along", "across"]
Side = Literal["up", "down", "left", "right"]


# What a person can correct in the measurement of a contact image.
CORRECTIONS = frozenset(("dark_on_light", "mask_px", "region_of_interest_px", "seed_px", "threshold"))
_IMAGE_KEYS = CORRECTIONS | {"background", "ppi", "mm_per_px", "scale_relative_std", "finger_axis_deg"}


def _listed(value: object) -> object:
    """Let a spreadsheet's cell hold a list, as in "250, 200"."""
    return [float(part) for part in value.split(",")] if isinstance(value, str) else value


class _Table(BaseModel):
    """A table of the manifest: no key that is not known, no value that changes."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class SemiAxes(_Table):
    """Semi-axes of a finger pad, mm."""

    palmar: Length
    distal: Length
    radial_ulnar: Length


class SemiAxesStd(_Table):
    """Standard uncertainties of semi-axes, mm."""

    palmar: LengthStd
    distal: LengthStd
    radial_ulnar: LengthStd


class Photograph(_Table):
    """One face of a finger: a photograph before a plain backdrop with its scale, or points of its outline."""

    face: Literal["palmar", "distal", "radial", "ulnar"]
    outline: str | None = None
    image: str | None = None
    ppi: Ppi | None = None
    mm_per_px: MmPerPx | None = None
    scale_relative_std: RelativeStd = 0.0
    tip: Side = "up"
    palmar_side: Side | None = None
    region_of_interest_px: Annotated[list[Finite], Field(min_length=4, max_length=4)] | None = None
    synthetic: bool = False

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.outline is None) == (self.image is None):
            raise ValueError("give either outline or image, one of the two")
        if self.image is not None and (self.ppi is None) == (self.mm_per_px is None):
            raise ValueError("an image needs its scale: give either ppi or mm_per_px")
        idle = self.model_fields_set - {"face", "outline", "scale_relative_std", "synthetic"}
        if self.outline is not None and idle:
            raise ValueError(f"beside an outline there is no use for {', '.join(sorted(idle))}")
        return self


class Finger(_Table):
    """A finger, with its semi-axes given or to be fitted to the outlines of its photographs."""

    name: Name
    semi_axes_mm: SemiAxes | None = None
    semi_axes_std_mm: SemiAxesStd | None = None
    photographs: list[Photograph] = []
    pad_thickness_mm: Length | None = None
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

    semi_major: Length
    semi_minor: Length
    std: LengthStd
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
    load_N: Load  # noqa: N815 (the unit's own letter)
    image: str | None = None
    background: str | None = None
    ppi: Ppi | None = None
    mm_per_px: MmPerPx | None = None
    scale_relative_std: RelativeStd = 0.0
    finger_axis_deg: Finite = 0.0
    dark_on_light: bool | None = None
    seed_px: Annotated[list[Finite], Field(min_length=2, max_length=2), BeforeValidator(_listed)] | None = (
        None
    )
    region_of_interest_px: (
        Annotated[list[int], Field(min_length=4, max_length=4), BeforeValidator(_listed)] | None
    ) = None
    mask_px: (
        Annotated[list[Annotated[list[Finite], Field(min_length=2, max_length=2)]], Field(min_length=3)]
        | None
    ) = None
    threshold: Finite | None = None
    ellipse_mm: ContactEllipse | None = None
    notes: str = ""
    synthetic: bool = False

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.image is None) == (self.ellipse_mm is None):
            raise ValueError("give either image or ellipse_mm, one of the two")
        if self.image is not None and (self.ppi is None) == (self.mm_per_px is None):
            raise ValueError("an image needs its scale: give either ppi or mm_per_px")
        idle = sorted(self.model_fields_set & _IMAGE_KEYS)
        if self.image is None and idle:
            raise ValueError(
                f"without an image there is no use for {', '.join(idle)}; remove what is not meant"
            )
        return self


class Curve(_Table):
    """Loading data of one finger at one wedge angle: a curve, or the radius R_g found from one elsewhere."""

    finger: str
    wedge_angle_deg: Annotated[float, Field(ge=0, le=90)]
    file: str | None = None
    columns: dict[Literal["force", "displacement", "area"], str] = {}
    effective_radius_mm: Length | None = None
    effective_radius_std_mm: LengthStd | None = None
    synthetic: bool = False

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if (self.file is None) == (self.effective_radius_mm is None):
            raise ValueError("give either file or effective_radius_mm, one of the two")
        idle = {"columns"} if self.file is None else {"effective_radius_std_mm"}
        if idle & self.model_fields_set:
            raise ValueError(f"there is no use for {idle.pop()} here; remove it")
        return self


class Uncertainty(_Table):
    """Standard uncertainties common to all observations."""

    wedge_angle_std_deg: AngleStd = 0.0
    roll_angle_std_deg: AngleStd = 0.0
    load_relative_std: RelativeStd = 0.0


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
                for key, name in (("outline", photograph.outline), ("image", photograph.image)):
                    if name is not None:
                        yield f"fingers[{i}].photographs[{j}].{key}", name
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
        content = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except FileNotFoundError:
        raise ManifestError(
            f"{path}: no such file; `fingerpad init DIR` writes a manifest to start from"
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise ManifestError(f"{path}: cannot be read ({error})") from error
    except (ValueError, RecursionError) as error:
        raise ManifestError(f"{path}: not valid TOML: {error}") from error
    study = _validated(Study, content, path.name, strict=True)
    if study.observations_csv is not None:
        rows = _read_rows(_inside(path.parent, study.observations_csv, path.name, "observations_csv"))
        study = study.model_copy(update={"observations": [*study.observations, *rows]})
    faults = [*_reference_faults(study), *_file_faults(study, path.parent)]
    if faults:
        raise ManifestError("\n".join(f"{path.name}: {fault}" for fault in faults))
    return study


def _validated(model: type[Model], content: Mapping[str, Any], where: str, *, strict: bool) -> Model:
    """Check `content`; cells of a spreadsheet are text and cannot be taken strictly."""
    try:
        return model.model_validate(content, strict=strict)
    except ValidationError as error:
        raise ManifestError("\n".join(f"{where}: {fault}" for fault in _value_faults(error))) from None


def _value_faults(error: ValidationError) -> Iterable[str]:
    """Say for each fault where it is, what is expected, and what was found."""
    unknown = [str(fault["loc"][-1]) for fault in error.errors() if fault["type"] == "extra_forbidden"]
    meant = {close for key in unknown for close in difflib.get_close_matches(key, _KEYS, n=1)}
    for fault in error.errors():
        place = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in fault["loc"]).lstrip(
            "."
        )
        key = str(fault["loc"][-1]) if fault["loc"] else ""
        message = fault["msg"].removeprefix("Value error, ").replace("Input should be", "expected")
        if fault["type"] == "missing" and key in meant:
            continue  # said with the unknown key that was meant for it
        if fault["type"] == "extra_forbidden":
            close = difflib.get_close_matches(key, _KEYS, n=1)
            yield f"{place}: unknown key" + (f"; did you mean {close[0]!r}?" if close else "")
        elif fault["type"] == "string_pattern_mismatch":
            yield f"{place}: write it with letters, digits and . _ + - only, found {fault['input']!r}"
        elif fault["type"] == "missing":
            yield f"{place}: required, but missing"
        elif isinstance(fault["input"], dict) and fault["type"] == "list_type":
            yield f"{place}: expected a list of tables: write [[{place}]] in place of [{place}]"
        elif isinstance(fault["input"], str | int | float | bool):
            yield f"{place}: {message}, found {repr(fault['input'])[:60]}"
        else:
            yield f"{place}: {message}" if place else message


def _read_rows(path: Path) -> list[Observation]:
    """Read observations from a spreadsheet's CSV: its headers are the keys of an observation."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            reader = csv.reader(file)
            lines = [(reader.line_num, cells) for cells in reader if any(cell.strip() for cell in cells)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise ManifestError(f"{path.name}: cannot be read as CSV ({error})") from error
    header = [cell.strip() for cell in lines[0][1]] if lines else []
    missing = {"name", "finger", "wedge_angle_deg", "load_N"} - set(header)
    if missing:
        hint = "; its cells are parted by semicolons, save it with commas" if ";" in "".join(header) else ""
        raise ManifestError(f"{path.name}: no column {', '.join(sorted(missing))} in the first line{hint}")
    repeated = sorted({title for title in header if title and header.count(title) > 1})
    if repeated:
        raise ManifestError(f"{path.name}: column {repeated[0]} is there {header.count(repeated[0])} times")
    if len(lines) == 1:
        raise ManifestError(f"{path.name}: holds no rows below its first line")
    return [_row(header, cells, f"{path.name}, line {line}") for line, cells in lines[1:]]


def _row(header: list[str], cells: list[str], where: str) -> Observation:
    if any(cell.strip() for cell in cells[len(header) :]):
        raise ManifestError(f"{where}: more cells than the header has columns")
    content: dict[str, Any] = {
        key: cell.strip() for key, cell in zip(header, cells, strict=False) if cell.strip()
    }
    ellipse = {key: content.pop(column) for column, key in _ELLIPSE_COLUMNS.items() if column in content}
    if ellipse:
        content["ellipse_mm"] = ellipse
    return _validated(Observation, content, where, strict=False)


def _reference_faults(study: Study) -> Iterable[str]:
    fingers = [finger.name for finger in study.fingers]
    for kind, names in (("fingers", fingers), ("observations", [row.name for row in study.observations])):
        folded = [name.casefold() for name in names]  # two files must differ by more than case
        for name in sorted({name for name in names if folded.count(name.casefold()) > 1}):
            count = folded.count(name.casefold())
            yield f"{kind}: the name {name!r} is given {count} times; names must differ by more than case"
    used = [(f"observation {row.name!r}", row.finger) for row in study.observations]
    used += [(f"curves[{index}]", curve.finger) for index, curve in enumerate(study.curves)]
    for place, name in used:
        if name not in fingers:
            yield f"{place}: no finger is named {name!r}; there is {', '.join(fingers)}"


def _file_faults(study: Study, folder: Path) -> Iterable[str]:
    for place, name in study.named_files():
        try:
            _inside(folder, name, "", place)
        except ManifestError as error:
            yield str(error).removeprefix(": ")


def _inside(folder: Path, name: str, where: str, place: str) -> Path:
    """Return the path of a file of the study, which must exist inside its folder."""
    path = folder / name
    try:
        known = path.is_file()
        inside = path.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError) as error:  # a name too long, a NUL in it, a loop of links
        raise ManifestError(f"{where}: {place}: {name[:60]!r} is no file name ({error})") from error
    if not inside:
        raise ManifestError(f"{where}: {place}: {name!r} leaves the study folder; copy the file into it")
    if not known:
        raise ManifestError(f"{where}: {place}: no file {name!r} in the study folder")
    return path
