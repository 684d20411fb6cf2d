"""The clock of a sequence on the time of its force signal."""

from fingerpad.exceptions import LoadingError
from fingerpad.image.sequence.force import ForceSignal, FrameRate


def frame_clock(
    frames_per_second: float,
    force: ForceSignal | None = None,
    *,
    start_time: float | None = None,
    contact_load: float | None = None,
) -> FrameRate:
    """Return the clock of frames taken at a steady rate.

    In order of preference: the first-contact frame lies where the force passes `contact_load`; the first
    frame lies at `start_time`; where the force's trigger rises; at the force's own start.

    Parameters
    ----------
    frames_per_second : float
        Rate at which the frames were taken.
    force : ForceSignal, optional
        The signal on whose time the frames are wanted.
    start_time : float, optional
        Time of the first frame, s.
    contact_load : float, optional
        Load of the first-contact frame, N.

    Returns
    -------
    FrameRate
        Times of the frames on the clock of the force.

    Raises
    ------
    LoadingError
        If both ways are given, the rate is not positive and finite, or the force never passes the load.

    Examples
    --------
    >>> force = ForceSignal([2.0, 2.1, 2.2], [0.0, 1.0, 2.0], trigger=[0.0, 5.0, 5.0])
    >>> [round(frame_clock(10, force, start_time=t).time_of(0, None), 3) for t in (None, 1.0)]
    [2.05, 1.0]
    """
    if start_time is not None and contact_load is not None:
        raise LoadingError("give either the time of the first frame or the load of first contact, not both")
    if force is not None and contact_load is not None:
        return FrameRate.of_contact(frames_per_second, force, contact_load)
    if force is not None and start_time is None:
        if force.trigger is not None:
            return FrameRate.of_trigger(frames_per_second, force)
        start_time = force.span[0]
    return FrameRate(frames_per_second, anchor_time=start_time or 0.0)
