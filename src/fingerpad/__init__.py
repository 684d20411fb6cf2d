"""Contact mechanics of the human finger pad.

The names that most people need are offered here, and imported when they are first used: ``__init__.pyi``
lists them.
"""

import lazy_loader

__version__ = "0.1.0"
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
