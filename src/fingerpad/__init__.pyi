from .contact import (
    Contact as Contact,
    Tissue as Tissue,
    fast_contact as fast_contact,
    hertz_contact as hertz_contact,
    solve_contact as solve_contact,
    youngs_modulus as youngs_modulus,
)
from .estimate import Estimate as Estimate
from .exceptions import FingerpadError as FingerpadError
from .figures.show import show as show
from .geometry import (
    Ellipse as Ellipse,
    Ellipsoid as Ellipsoid,
    Paraboloid as Paraboloid,
    Placement as Placement,
)
from .image import (
    ForceSignal as ForceSignal,
    FrameRate as FrameRate,
    Scale as Scale,
    combine_faces as combine_faces,
    measure_coin as measure_coin,
    measure_contact_image as measure_contact_image,
    measure_photograph as measure_photograph,
    measure_sequence as measure_sequence,
    open_frames as open_frames,
    read_force_signal as read_force_signal,
    read_image as read_image,
)
from .loading import (
    LoadingCurve as LoadingCurve,
    contact_law as contact_law,
    fit_loading_curve as fit_loading_curve,
    read_loading_curve as read_loading_curve,
)
from .simulator import simulator_law as simulator_law
from .study.pipeline import run_study as run_study
from .study.results.load import load_results as load_results
from .uncertainty import (
    Inputs as Inputs,
    pad_model as pad_model,
    pad_uncertainty as pad_uncertainty,
    pool as pool,
    propagate as propagate,
    run_monte_carlo as run_monte_carlo,
)

__version__: str
