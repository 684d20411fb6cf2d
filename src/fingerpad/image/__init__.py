"""Measure pictures: contact images, and photographs of a finger's faces."""

from fingerpad.image.coin import Coin, measure_coin
from fingerpad.image.contact_image.manual import BrushStroke, RegionPolygon
from fingerpad.image.contact_image.measure import (
    PreparedContactImage,
    measure_contact_image,
    prepare_contact_image,
)
from fingerpad.image.contact_image.result import ContactImageResult
from fingerpad.image.contact_image.view import ContactImageOptions
from fingerpad.image.ellipse import ImageEllipse, PlaneEllipse, ellipse_of_polygon, interpolated_ellipse
from fingerpad.image.ellipse_fit import fit_aligned_ellipse, fit_ellipse
from fingerpad.image.grid import Grid, measure_grid
from fingerpad.image.levels import MEMORY_LIMIT
from fingerpad.image.overlay import draw_overlay, write_overlay
from fingerpad.image.photograph.faces import (
    FACE_AXES,
    SEMI_AXES,
    Face,
    FaceSemiAxes,
    PadSemiAxes,
    combine_faces,
    implausible_size,
)
from fingerpad.image.photograph.manual import (
    photograph_from_ellipse,
    photograph_from_handles,
    with_marked_points,
)
from fingerpad.image.photograph.measure import measure_photograph
from fingerpad.image.photograph.points import face_from_outline, read_marks, read_outline
from fingerpad.image.photograph.result import PhotographFit
from fingerpad.image.read import Picture, read_colour_image, read_image
from fingerpad.image.scale import Scale
from fingerpad.image.sequence.force import (
    ForceSignal,
    FrameClock,
    FrameRate,
    FrameStamps,
    alignment_scatter,
    frame_clock,
    read_force_signal,
    read_frame_stamps,
)
from fingerpad.image.sequence.frames import Frame, Frames, open_frames
from fingerpad.image.sequence.measure import (
    SequenceSettings,
    TextureScan,
    assign_times,
    estimate_settings,
    measure_frames,
    measure_sequence,
    scan_texture,
)
from fingerpad.image.sequence.phases import PHASES, Phase, PhaseIntervals, phase_intervals, phases_of
from fingerpad.image.sequence.result import FrameResult, SequenceSummary, sequence_summary
from fingerpad.image.subject import Subject, guess_subject

__all__ = [
    "FACE_AXES",
    "MEMORY_LIMIT",
    "PHASES",
    "SEMI_AXES",
    "BrushStroke",
    "Coin",
    "ContactImageOptions",
    "ContactImageResult",
    "Face",
    "FaceSemiAxes",
    "ForceSignal",
    "Frame",
    "FrameClock",
    "FrameRate",
    "FrameResult",
    "FrameStamps",
    "Frames",
    "Grid",
    "ImageEllipse",
    "PadSemiAxes",
    "Phase",
    "PhaseIntervals",
    "PhotographFit",
    "Picture",
    "PlaneEllipse",
    "PreparedContactImage",
    "RegionPolygon",
    "Scale",
    "SequenceSettings",
    "SequenceSummary",
    "Subject",
    "TextureScan",
    "alignment_scatter",
    "assign_times",
    "combine_faces",
    "draw_overlay",
    "ellipse_of_polygon",
    "estimate_settings",
    "face_from_outline",
    "fit_aligned_ellipse",
    "fit_ellipse",
    "frame_clock",
    "guess_subject",
    "implausible_size",
    "interpolated_ellipse",
    "measure_coin",
    "measure_contact_image",
    "measure_frames",
    "measure_grid",
    "measure_photograph",
    "measure_sequence",
    "open_frames",
    "phase_intervals",
    "phases_of",
    "photograph_from_ellipse",
    "photograph_from_handles",
    "prepare_contact_image",
    "read_colour_image",
    "read_force_signal",
    "read_frame_stamps",
    "read_image",
    "read_marks",
    "read_outline",
    "scan_texture",
    "sequence_summary",
    "with_marked_points",
    "write_overlay",
]
