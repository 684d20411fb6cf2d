"""The errors that fingerpad raises on purpose.

Every message names the argument or file, what was found there, and the way out.
"""


class FingerpadError(Exception):
    """Any error that fingerpad raises on purpose."""


class GeometryError(FingerpadError, ValueError):
    """A length, an angle or a curvature that no finger pad or contact can have."""


class ConvergenceError(FingerpadError):
    """A contact whose pressure was not found."""


class CalibrationError(FingerpadError, ValueError):
    """A scale that is missing, impossible or contradicted by the picture."""


class ImageError(FingerpadError):
    """A picture that cannot be read or in which nothing can be measured."""


class LoadingError(FingerpadError, ValueError):
    """A loading curve that cannot be read or used."""


class FitError(FingerpadError):
    """Data that do not determine the model fitted to them."""


class UncertaintyError(FingerpadError, ValueError):
    """A variance, covariance or set of estimates that no uncertainty can be computed from."""


class FigureError(FingerpadError, ValueError):
    """Settings with which a figure cannot be drawn."""


class ArchiveError(FingerpadError):
    """A ZIP that is no study, or holds what no study holds."""


class StoreError(FingerpadError):
    """A study's store of results that cannot be opened, read or written."""


class ClusterError(FingerpadError):
    """A scheduler or its workers that cannot be used."""


class CorrectionConflict(StoreError):  # noqa: N818 (it is no fault)
    """Someone else corrected the same thing meanwhile; `latest` is their record, None if all are gone."""

    def __init__(self, message: str, latest: object = None) -> None:
        super().__init__(message)
        self.latest = latest


class EditConflict(StoreError):  # noqa: N818 (it is no fault)
    """Someone else edited the study in the meantime."""


class ManifestError(FingerpadError, ValueError):
    """A study manifest that cannot be acted upon."""


def is_interrupt(error: BaseException | None) -> bool:
    """Return whether an interrupt caused an error, as imports raise other errors for one."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        # Of one that comes while it makes a model, pydantic keeps the name alone.
        if type(error).__name__ == "SchemaError" and "KeyboardInterrupt" in str(error):
            return True
        error = error.__cause__
    return error is not None


def reason_of(error: Exception, otherwise: str) -> str:
    """Return why something went wrong, in one line where the error is not one of fingerpad's.

    `otherwise` begins that line, and names the file or the step.
    """
    if isinstance(error, FingerpadError):
        return str(error)
    if isinstance(error, OSError) and error.strerror:
        return (
            f"{otherwise} ({error.strerror})"
            if error.filename is None
            else f"{error.filename}: {error.strerror}"
        )
    return f"{otherwise} ({' '.join(f'{type(error).__name__}: {error}'.split())})"
