"""Settings of all tests."""

import os

from hypothesis import settings

# The same examples in every run, and no deadline, since a busy machine is no fault.
# HYPOTHESIS_PROFILE=nightly draws new examples each time, and more of them.
settings.register_profile("default", derandomize=True, deadline=None)
settings.register_profile("nightly", derandomize=False, deadline=None, max_examples=1000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))
