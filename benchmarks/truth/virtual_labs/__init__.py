"""Virtual labs: whole studies of fingers whose truth is known, to see whether 95 % intervals hold it.

``python -m benchmarks virtual_labs --first-seed 100`` makes studies from the physics
alone, runs ``fingerpad run`` on each and compares what it writes with the truth. Nothing here imports
``fingerpad``: the pad, its contact on deep tissue or on a layer bonded to bone, contact images,
photographs, outlines and loading curves have code of their own.

Each error is drawn from the distribution that the lab's manifest states: scales, semi-axes, pose (one
error for each angle), force (a gain that all presses share, and one of each press), Poisson's ratio,
thickness. Three things cannot be stated and are there all the same: the noise of outline points, the noise
of curves, and in some labs a stage that yields by 0.005 to 0.02 mm/N. Outlines are aligned with the
finger; areas of curves have the camera's true scale; the stage of most labs does not yield.

Labs of odd seed have bone; four fingers of ten are no ellipsoid ("other": superelliptic in the side view,
or with another dorsal half). The simulator is checked before each table, in ``checks.py``: Hertz theory
within 0.2 %, the layer against known results for paraboloids within 1 %, rendered areas against the
outline of the pressure.
"""
