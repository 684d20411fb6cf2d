from .coin import (
    Coin as Coin,
    measure_coin as measure_coin,
)
from .contact_image.manual import (
    BrushStroke as BrushStroke,
    RegionPolygon as RegionPolygon,
)
from .contact_image.measure import (
    PreparedContactImage as PreparedContactImage,
    measure_contact_image as measure_contact_image,
    prepare_contact_image as prepare_contact_image,
)
from .contact_image.result import ContactImageResult as ContactImageResult
from .contact_image.view import ContactImageOptions as ContactImageOptions
from .ellipse import (
    ImageEllipse as ImageEllipse,
    PlaneEllipse as PlaneEllipse,
    ellipse_of_polygon as ellipse_of_polygon,
    interpolated_ellipse as interpolated_ellipse,
)
from .ellipse_fit import (
    fit_aligned_ellipse as fit_aligned_ellipse,
    fit_ellipse as fit_ellipse,
)
from .grid import (
    Grid as Grid,
    measure_grid as measure_grid,
)
from .levels import MEMORY_LIMIT as MEMORY_LIMIT
from .overlay import (
    draw_overlay as draw_overlay,
    write_overlay as write_overlay,
)
from .photograph.faces import (
    FACE_AXES as FACE_AXES,
    SEMI_AXES as SEMI_AXES,
    Face as Face,
    FaceSemiAxes as FaceSemiAxes,
    PadSemiAxes as PadSemiAxes,
    combine_faces as combine_faces,
    implausible_size as implausible_size,
)
from .photograph.manual import (
    face_from_outline as face_from_outline,
    photograph_from_ellipse as photograph_from_ellipse,
    photograph_from_handles as photograph_from_handles,
    read_marks as read_marks,
    read_outline as read_outline,
    with_marked_points as with_marked_points,
)
from .photograph.measure import measure_photograph as measure_photograph
from .photograph.result import PhotographFit as PhotographFit
from .read import (
    Picture as Picture,
    read_image as read_image,
)
from .scale import Scale as Scale
from .sequence.force import (
    ForceSignal as ForceSignal,
    FrameClock as FrameClock,
    FrameRate as FrameRate,
    FrameStamps as FrameStamps,
    alignment_scatter as alignment_scatter,
    frame_clock as frame_clock,
    read_force_signal as read_force_signal,
    read_frame_stamps as read_frame_stamps,
)
from .sequence.frames import (
    Frame as Frame,
    Frames as Frames,
    open_frames as open_frames,
)
from .sequence.measure import (
    SequenceSettings as SequenceSettings,
    TextureScan as TextureScan,
    assign_times as assign_times,
    estimate_settings as estimate_settings,
    measure_frames as measure_frames,
    measure_sequence as measure_sequence,
    scan_texture as scan_texture,
)
from .sequence.phases import (
    PHASES as PHASES,
    Phase as Phase,
    PhaseIntervals as PhaseIntervals,
    phase_intervals as phase_intervals,
    phases_of as phases_of,
)
from .sequence.result import (
    FrameResult as FrameResult,
    SequenceSummary as SequenceSummary,
    sequence_summary as sequence_summary,
)
from .subject import (
    Subject as Subject,
    guess_subject as guess_subject,
)
