"""What measuring one picture may take."""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """What measuring may take; a picture that needs more fails with its reason.

    Attributes
    ----------
    seconds : float
        Time for one picture.
    memory_gb : float
        Memory beyond that of an idle process, 10⁹ bytes. Enforced where the system can (Linux).
    """

    seconds: float = 300.0
    memory_gb: float = 4.0

    def exceed(self, other: "Limits") -> bool:
        """Tell whether something that `other` stopped may fit into these."""
        return self.seconds > other.seconds or self.memory_gb > other.memory_gb


DEFAULT_LIMITS: Final = Limits()
