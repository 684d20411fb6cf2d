"""An open study: its current manifest, items, images and results."""

import math
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path, PurePosixPath
from threading import Lock
from typing import Any, Final, TypeAlias, TypeVar, cast
from urllib.parse import quote

import numpy as np

from fingerpad._files import digest_of
from fingerpad.exceptions import FingerpadError, ImageError, ManifestError
from fingerpad.image import open_frames
from fingerpad.study.corrections.log import SECOND_OPERATOR_NAME, CorrectionLog, parts_of_item, picture_digest
from fingerpad.study.editing.edit import Edit, change_study
from fingerpad.study.engine.store import STORE_NAME
from fingerpad.study.manifest.load import STUDY_NAME, Kind, LoadedStudy, file_inside, is_as_read, load_study
from fingerpad.study.manifest.models import (
    Contact,
    ContactSequence,
    Finger,
    Observation,
    Photograph,
    Study,
    validated,
)
from fingerpad.study.measuring.fingers import FingerResult, given_pad
from fingerpad.study.results.load import Results, read_rows
from fingerpad.study.results.result_set import RERUN, quick_faults, result_files, result_set_stamp
from fingerpad.study.results.summary_file import SummaryFile
from fingerpad.study.share import DOCUMENTS
from fingerpad.study.status import Missing, missing
from fingerpad.web.answers import RequestError
from fingerpad.web.events import Events, StudyEvent
from fingerpad.web.pictures import Cache, ImageLocation, Pictures
from fingerpad.web.run_job import RunJob

_MOST_FILES: Final = 100_000
_TIMEOUT_S: Final = 30.0
# Where an incomplete contact, or a new file, is measured: no model may use them.
PLACEHOLDERS: Final[Mapping[str, Any]] = {"finger": "none", "wedge_angle_deg": 0, "load_N": 1}
Placed = TypeVar("Placed", Observation, ContactSequence)
# Of a file or folder, what changes with it; None where it is not there.
Stamp: TypeAlias = tuple[int, int, int] | None
# Results of studies that are open in several windows, or what is wrong with them.
_RESULTS: Final[Cache[tuple[Results | None, list[str]]]] = Cache(3)


class StudySession:
    """A study folder and its results, and the events of its windows; pictures are cached for all studies."""

    def __init__(self, folder: Path, *, out: Path, pictures: Pictures) -> None:
        self.folder, self.out, self.name = folder, out, folder.name
        self.pictures, self.events = pictures, Events()
        self.run_job = RunJob(self.events)
        self.corrections = CorrectionLog(folder)
        self.second_operator = CorrectionLog(folder, SECOND_OPERATOR_NAME)
        self._counts: Cache[int] = Cache(10_000)
        self._digests: Cache[str] = Cache(10_000)
        self._read: tuple[dict[Path, Stamp], LoadedStudy, list[Missing]] | None = None
        self._lock = Lock()

    def address(self, path: str) -> str:
        """Return the address of a request about this study."""
        return f"/api/studies/{quote(self.name, safe='')}{path}"

    def tell_changed(self) -> None:
        """Tell every window that the study or its files have changed."""
        self.events.send(StudyEvent(digest=self.read().digest))

    def close(self) -> None:
        """Cancel the run, and wait until it has stopped; disconnect the listeners."""
        self.run_job.cancel()
        self.events.end()
        self.run_job.wait(_TIMEOUT_S)

    def read(self) -> LoadedStudy:
        """Return the study, loaded again if one of its files has changed."""
        return self._loaded()[0]

    def missing(self) -> list[Missing]:
        """Return what the study lacks."""
        return self._loaded()[1]

    def study(self) -> Study:
        """Return the complete part of the study."""
        return self.read().study

    def _loaded(self) -> tuple[LoadedStudy, list[Missing]]:
        with self._lock:
            while self._read is None or not self._is_as_stamped(self._read[0]):
                # Stamped first: what is saved meanwhile is read again.
                stamps, loaded = self._stamps(), self._load()
                self._read = stamps, loaded, missing(loaded)
            return self._read[1:]

    def _named(self) -> list[Path]:
        """Return the manifest, and the spreadsheet that it names as far as it was read."""
        sheet = self._read[1].study.observations_csv if self._read else None
        return [self.folder / name for name in (STUDY_NAME, sheet) if name is not None]

    def _stamps(self) -> dict[Path, Stamp]:
        return self._scanned()[1] | {path: _stamp_of(path) for path in self._named()}

    def _is_as_stamped(self, stamps: Mapping[Path, Stamp]) -> bool:
        return all(stamps.get(path, ()) == _stamp_of(path) for path in {*stamps, *self._named()})

    def _load(self) -> LoadedStudy:
        """Return the study; one without anything in it where the manifest cannot be read."""
        try:
            return load_study(self.folder / STUDY_NAME)
        except ManifestError as error:
            return LoadedStudy.empty(self.folder, str(error).splitlines())

    def change(self, edits: Sequence[Edit], expected: str) -> None:
        """Change the manifest: all edits or none."""
        changed = change_study(self.folder, edits, expected=expected, before=self.read())
        with self._lock:
            self._read = {}, changed, missing(changed)
            stamps = self._stamps()
            # What was written need not be read again, unless someone has changed it meanwhile.
            self._read = (stamps, *self._read[1:]) if is_as_read(changed) else None

    def with_incomplete(self) -> Study:
        """Return the study with the names of what is incomplete too, whose corrections are kept as well."""
        study = self.study()
        fingers, observations = list(study.fingers), list(study.observations)
        for one in self.read().incomplete:
            if one.kind == "finger":
                faces = [Photograph.model_construct(None, **each) for each in one.tables[1:]]
                fingers.append(Finger.model_construct(None, name=one.key, photographs=faces))
            elif one.kind == "observation":
                observations.append(Observation.model_construct(None, **{**one.content, "name": one.key}))
        return study.model_copy(update={"fingers": fingers, "observations": observations})

    def finger(self, name: str) -> Finger | None:
        """Return a finger by its name, None where it is incomplete."""
        table = self.read().table("finger", name)
        return table.model if table and table.complete and isinstance(table.model, Finger) else None

    def contact(self, item: str) -> tuple[Contact, bool]:
        """Return the table of a contact image, or of a frame's sequence, and whether it is complete.

        One that is incomplete can be measured if its scale is known. Placeholders stand for its finger, angle
        and load, which no model may use.
        """
        kind, name, _ = parts_of_item(item)
        if kind == "frame":
            return self._contact("sequence", name, ContactSequence)
        return self._contact("observation", name, Observation)

    def sequence(self, name: str) -> ContactSequence:
        """Return a sequence by its name; of one that is incomplete the force may be empty."""
        return self._contact("sequence", name, ContactSequence)[0]

    def _contact(self, kind: Kind, name: str, model: type[Placed]) -> tuple[Placed, bool]:
        table = self.read().table(kind, name)
        if table and table.complete and isinstance(table.model, model):
            return table.model, True
        content = table.stated if table else {}
        if not content.get("file"):
            raise RequestError.not_there(f"no {kind} with a picture is named {name[:80]!r}")
        if not content.get("scale"):
            raise RequestError.impossible("state the scale of the picture")
        needed = {key: value for key, value in PLACEHOLDERS.items() if key in model.model_fields}
        force = {"force": ""} if model is ContactSequence else {}
        return validated(model, {**force, **content, **needed, "name": name}, name, strict=False), False

    def photograph(self, item: str) -> tuple[Finger | None, Photograph]:
        """Return a photograph by finger and file, and its finger, None where that is incomplete."""
        _, name, file = parts_of_item(item)
        found = next((one for one in self._photographs(name) if one.get("file") == file), None)
        if found is None:
            raise RequestError.not_there(f"no item is named {item!r}")
        if found.get("face") is None:
            raise RequestError.impossible("state which face the photograph shows")
        if found.get("scale") is None:
            raise RequestError.impossible("state the scale of the photograph")
        return self.finger(name), validated(Photograph, found, item, strict=False)

    def _photographs(self, finger: str) -> list[dict[str, Any]]:
        return cast(list[dict[str, Any]], self._stated("finger", finger).get("photographs", []))

    def _stated(self, kind: Kind, key: str) -> dict[str, Any]:
        table = self.read().table(kind, key)
        return {} if table is None else table.stated

    def image_location(self, item: str) -> ImageLocation:
        """Return the location of an item's image; only files named by the manifest."""
        if item.startswith("file:"):
            return ImageLocation(self.file(item.removeprefix("file:")), colour=True)
        kind, name, part = parts_of_item(item)
        if kind == "photograph":
            file = part if any(one.get("file") == part for one in self._photographs(name)) else None
            coloured = True
        else:
            stated = self._stated("observation" if kind == "observation" else "sequence", name)
            file, coloured = stated.get("file"), stated.get("surface", self.study().surface) == "smooth"
        if not isinstance(file, str):
            raise RequestError.not_there(f"no item with a picture is named {item[:80]!r}")
        if kind in {"observation", "photograph"}:
            return ImageLocation(self.file(file), colour=coloured)
        if not part.isdecimal() or len(part) > 9:
            raise RequestError.not_there(f"{item[:80]!r} is no frame: write it as {name}#12")
        return ImageLocation(self.sequence_path(file), frame=int(part), colour=coloured)

    def shape_of(self, item: str) -> tuple[int, int] | None:
        """Return rows and columns of an item's image, None where it has none."""
        kind, name, _ = parts_of_item(item)
        if kind == "phases" or (kind == "observation" and not self._stated("observation", name).get("file")):
            return None
        rows, columns = self.pictures.pixels(self.image_location(item)).shape[:2]
        return rows, columns

    def picture_digest(self, item: str) -> str:
        """Return the SHA-256 of what an item's corrections are about; empty where it is not there."""
        return picture_digest(item, self.with_incomplete(), self.folder, self._digest)

    def _digest(self, name: str) -> str:
        """Return the SHA-256 of a file of the study, read again only when it has changed."""
        if (path := self._inside(name)) is None:
            return ""
        return self._digests.get((path, _stamp_of(path)), lambda: digest_of(path))

    def count_frames(self, name: str) -> int | None:
        """Return the number of frames of a folder, TIFF or video, None where it cannot be opened."""
        if (path := self._inside(name)) is None:
            return None
        limit = self.pictures.memory_limit
        with suppress(ImageError):
            key = name, _stamp_of(path)
            return self._counts.get(key, lambda: open_frames(path, memory_limit=limit).count)
        return None

    def files(self) -> dict[str, int]:
        """Return the sizes of all files of the study folder except results, by their relative names."""
        return dict(sorted(self._scanned()[0].items()))

    def _scanned(self) -> tuple[dict[str, int], dict[Path, Stamp]]:
        """Return these files, and the folders that hold them with their stamps."""
        sizes: dict[str, int] = {}
        stamps = {self.folder: _stamp_of(self.folder)}
        for here, folders, names in os.walk(self.folder):
            place = Path(here)
            inner = [place / name for name in folders if not name.startswith(".")]
            inner = [path for path in inner if path != self.out and not (path / STORE_NAME).is_file()]
            stamps |= {path: _stamp_of(path) for path in inner}
            folders[:] = [path.name for path in inner]
            for path in (place / name for name in names if not name.startswith(".")):
                name = path.relative_to(self.folder).as_posix()
                if name not in DOCUMENTS and not path.is_symlink() and (stamp := _stamp_of(path)):
                    sizes[name] = stamp[0]
            if len(sizes) >= _MOST_FILES:
                break
        return sizes, stamps

    def file(self, name: str) -> Path:
        """Return the path of a file of the study, if it is one."""
        path = self._inside(name)
        if path is None or not path.is_file():
            raise RequestError.not_there(f"the study holds no file {name[:80]!r}")
        return path

    def sequence_path(self, name: str) -> Path:
        """Return the path of a sequence: a file of the study, or a folder of frames."""
        path = self._inside(name)
        if path is None or not path.exists():
            raise RequestError.not_there(f"the study holds no sequence {name[:80]!r}")
        return file_inside(self.folder, name, may_be_folder=True)

    def _inside(self, name: str) -> Path | None:
        """Return the path of a name, None if it is outside the study or not an input."""
        parts = PurePosixPath(name).parts
        if not parts or any(part.startswith(".") for part in parts) or parts[0] in DOCUMENTS:
            return None
        path = self.folder / name
        try:
            real = path.resolve()
        except (OSError, ValueError, RuntimeError):  # a NUL, a name too long, a loop of links
            return None
        inside = real.is_relative_to(self.folder.resolve()) and not real.is_relative_to(self.out.resolve())
        return path if inside else None

    def results(self) -> Results | None:
        """Return the tables of the last run, None if there are none or they are damaged."""
        return self.results_or_faults()[0]

    def results_or_faults(self) -> tuple[Results | None, list[str]]:
        """Return the same, and what was wrong with the files, except overlays, when the tables were read.

        They are checked and read once for each result set, as it may be imported. A file that was changed in
        place later is named by what reads it, and by ``fingerpad verify``.
        """
        return _RESULTS.get((self.out, result_set_stamp(self.out)), self._read_results)

    def _read_results(self) -> tuple[Results | None, list[str]]:
        faults = quick_faults(self.out, lambda name: not name.startswith("overlays/"))
        if faults or not result_files(self.out):
            return None, faults
        try:
            found = Results(table=read_rows(self.out), summary=SummaryFile.read(self.out))
        except FingerpadError as error:
            return None, [str(error).removesuffix(f"; {RERUN}").removeprefix(f"{self.out}{os.sep}")]
        # pandas copies all units with each column that is taken, half of a plot's time.
        found.table.attrs.clear()
        return found, []

    def require_results(self) -> Results:
        """Return the results of the last run; refuse where there are none, or they are damaged."""
        found, faults = self.results_or_faults()
        if faults:
            raise RequestError.conflict(f"{'; '.join(faults[:3])}: {RERUN}")
        if found is None:
            raise RequestError.not_there("there are no results yet: run the study")
        return found

    def known_finger(self, name: str) -> FingerResult | None:
        """Return a finger's semi-axes, entered or of the last run; None where they are unknown."""
        finger = self.finger(name)
        if finger is None or not (finger.photographs or finger.semi_axes_mm):
            return None
        if finger.semi_axes_mm is not None:
            return given_pad(finger)
        found = self.results()
        record = found.summary.finger(name) if found else None
        if record is None or math.isnan(record.palmar_mm):
            return None
        radii = (one.outline_radii_deg_mm for one in record.photographs)
        return FingerResult(
            manifest=finger,
            semi_axes=np.array(record.semi_axes_mm),
            covariance=np.array(record.covariance_mm2),
            source="photographs",
            outline_radii=tuple(tuple(one) for one in radii if one),
            scale=record.scale,
        )


def _stamp_of(path: Path) -> Stamp:
    try:
        status = path.stat()
    except (OSError, ValueError):
        return None
    return status.st_size, status.st_mtime_ns, status.st_ino
