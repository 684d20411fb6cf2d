"""What the API answers: the models behind the OpenAPI document and the types of the page's scripts.

Every key is required, so that the page finds what the types promise; what may be missing is null. Lengths of
a picture are pairs (row, column) in pixels.
"""

from fingerpad.web.answers.base import Answer, Refusal
from fingerpad.web.answers.events import EVENTS
from fingerpad.web.answers.files import (
    BundleContents,
    FileGuess,
    JoinedTable,
    PatternMatches,
    PictureInfo,
    UploadedFile,
)
from fingerpad.web.answers.measurements import (
    ContactLevels,
    ContactMeasurement,
    ContactModel,
    ContactNumbers,
    Corrections,
    LengthMeasurement,
    PhotographMeasurement,
    RectifiedPictures,
    ScaleMeasurement,
    SimilarImages,
)
from fingerpad.web.answers.results import (
    Audit,
    Budget,
    BudgetCheck,
    FigureDetails,
    Figures,
    ModelCheck,
    ModelHeadline,
    PadGeometry,
    Plot,
    PlottedGroup,
    PlottedRows,
    Rows,
)
from fingerpad.web.answers.study import (
    Frames,
    RunStatus,
    SecondOperator,
    SequenceSignal,
    Session,
    State,
    StateAfterRemoval,
    StateAfterRestore,
)

__all__ = [
    "EVENTS",
    "Answer",
    "Audit",
    "Budget",
    "BudgetCheck",
    "BundleContents",
    "ContactLevels",
    "ContactMeasurement",
    "ContactModel",
    "ContactNumbers",
    "Corrections",
    "FigureDetails",
    "Figures",
    "FileGuess",
    "Frames",
    "JoinedTable",
    "LengthMeasurement",
    "ModelCheck",
    "ModelHeadline",
    "PadGeometry",
    "PatternMatches",
    "PhotographMeasurement",
    "PictureInfo",
    "Plot",
    "PlottedGroup",
    "PlottedRows",
    "RectifiedPictures",
    "Refusal",
    "Rows",
    "RunStatus",
    "ScaleMeasurement",
    "SecondOperator",
    "SequenceSignal",
    "Session",
    "SimilarImages",
    "State",
    "StateAfterRemoval",
    "StateAfterRestore",
    "UploadedFile",
]
