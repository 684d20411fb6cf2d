"""Measure pictures: contact images, and photographs of a finger's faces."""

from fingerpad.image.coin.measure import Coin, measure_coin
from fingerpad.image.colour import read_colour_image
from fingerpad.image.ellipse_fit import (
    AlignedEllipseFit,
    EllipseFit,
    RegionEllipse,
    equal_area_ellipse,
    fit_aligned_ellipse,
    fit_ellipse,
)
from fingerpad.image.imprint.edits import BrushStroke, HandEllipse
from fingerpad.image.imprint.measure import measure_imprint
from fingerpad.image.imprint.overlay import draw_overlay, write_overlay
from fingerpad.image.imprint.prepare import PreparedImprint, prepare_imprint
from fingerpad.image.imprint.result import FLAGS, PLAUSIBLE_RIDGE_PERIOD_MM, Imprint, ImprintSettings
from fingerpad.image.photograph._face_frame import Direction
from fingerpad.image.photograph.by_hand import (
    photograph_from_ellipse,
    photograph_from_handles,
    with_points,
)
from fingerpad.image.photograph.direct import direct_semi_axes
from fingerpad.image.photograph.faces import (
    FACE_AXES,
    SEMI_AXES,
    Face,
    FaceSemiAxes,
    OutlineSemiAxes,
    combine_faces,
    implausible_size,
)
from fingerpad.image.photograph.measure import (
    PHOTOGRAPH_FLAGS,
    PhotographFit,
    measure_photograph,
)
from fingerpad.image.photograph.outline import (
    face_from_outline,
    read_marks,
    read_outline,
    semi_axes_from_outlines,
)
from fingerpad.image.photograph.outline_fit import OutlineFit, fit_outline_ellipse
from fingerpad.image.photograph.overlay import draw_photograph_overlay, write_photograph_overlay
from fingerpad.image.read import Picture, read_image
from fingerpad.image.scale import Scale
from fingerpad.image.sequence.clock import frame_clock
from fingerpad.image.sequence.force import (
    ForceSignal,
    FrameClock,
    FrameRate,
    FrameStamps,
    read_force_signal,
    read_frame_stamps,
)
from fingerpad.image.sequence.frames import Frame, Frames, open_frames
from fingerpad.image.sequence.measure import measure_frames, measure_sequence, place_in_time
from fingerpad.image.sequence.phases import PHASES, Phase, phases_of
from fingerpad.image.sequence.reading import Place, Reading, Survey, learn_reading, survey_frames
from fingerpad.image.sequence.result import FrameResult, SequenceSummary, sequence_summary
from fingerpad.image.synthetic.coin import SyntheticCoin, render_coin
from fingerpad.image.synthetic.finger import Backdrop, SyntheticFinger, render_finger
from fingerpad.image.synthetic.imprint import SyntheticImprint, outline_points, render_imprint
from fingerpad.image.synthetic.press import SyntheticPress, synthetic_press

__all__ = [
    "FACE_AXES",
    "FLAGS",
    "PHASES",
    "PHOTOGRAPH_FLAGS",
    "PLAUSIBLE_RIDGE_PERIOD_MM",
    "SEMI_AXES",
    "AlignedEllipseFit",
    "Backdrop",
    "BrushStroke",
    "Coin",
    "Direction",
    "EllipseFit",
    "Face",
    "FaceSemiAxes",
    "ForceSignal",
    "Frame",
    "FrameClock",
    "FrameRate",
    "FrameResult",
    "FrameStamps",
    "Frames",
    "HandEllipse",
    "Imprint",
    "ImprintSettings",
    "OutlineFit",
    "OutlineSemiAxes",
    "Phase",
    "PhotographFit",
    "Picture",
    "Place",
    "PreparedImprint",
    "Reading",
    "RegionEllipse",
    "Scale",
    "SequenceSummary",
    "Survey",
    "SyntheticCoin",
    "SyntheticFinger",
    "SyntheticImprint",
    "SyntheticPress",
    "combine_faces",
    "direct_semi_axes",
    "draw_overlay",
    "draw_photograph_overlay",
    "equal_area_ellipse",
    "face_from_outline",
    "fit_aligned_ellipse",
    "fit_ellipse",
    "fit_outline_ellipse",
    "frame_clock",
    "implausible_size",
    "learn_reading",
    "measure_coin",
    "measure_frames",
    "measure_imprint",
    "measure_photograph",
    "measure_sequence",
    "open_frames",
    "outline_points",
    "phases_of",
    "photograph_from_ellipse",
    "photograph_from_handles",
    "place_in_time",
    "prepare_imprint",
    "read_colour_image",
    "read_force_signal",
    "read_frame_stamps",
    "read_image",
    "read_marks",
    "read_outline",
    "render_coin",
    "render_finger",
    "render_imprint",
    "semi_axes_from_outlines",
    "sequence_summary",
    "survey_frames",
    "synthetic_press",
    "with_points",
    "write_overlay",
    "write_photograph_overlay",
]
