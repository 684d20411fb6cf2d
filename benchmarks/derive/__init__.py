"""Fit the constants of the library again: ``python -m benchmarks.derive NAME``; without a name it lists them.

``--images N`` of each condition and ``--seeds FIT OTHER`` say which images. A module here fits one calibrated
model, or two that belong together, to images of known truth of one seed, and shows on images of the other how
well the values in the code and those fitted do. The images come from renderers in `benchmarks` that share no
model with the library; values of contacts and photographs were fitted to two more, in the history up to
355ef79c. Nothing is changed: who takes a new value edits the model's dataclass, raises the measurement's
version and records its pins.

To add one: constants that were fitted stand in a module of the library named ``calibration.py``, as a frozen
dataclass with one field a line, its unit and meaning in the comment behind. ``benchmarks/derive/NAME.py`` has
``PROBLEMS``, a tuple of `benchmarks.derive.fit.Problem`: the model in use, the fields that place the result,
those that state its uncertainty, the reason for each field that is not fitted, a function that makes the
sample from a number of images and a seed, and one that compares it with the truth under other values of the
model. Where least squares of errors are not how it is done, a function ``show(images, seed, other)`` prints
the table instead, for the model that ``MODEL`` names. A field that is neither fitted nor explained fails
tests/image/test_derive.py.
"""
