"""Contents of files with one of their words or some of their bytes changed at random."""

import random
import re
from contextlib import suppress

# Values that are right somewhere and wrong elsewhere, as JSON and mostly TOML write them.
ODD = (
    "0", "-1", "1", f"{2**63 - 1}", "1e308", "-0.0", "NaN", "inf", "true", "false", "null", '""', '"x"',
    r'"\u0000"', '"../a.png"', '"ü☃"', '"/dev/zero"', '"."', '"=1+1"', '"a/b"', '"#"', '"left_index_ellipse"',
    f'"{300 * "a"}"', "[]", "[[]]", "[1, 2]", "{}", '["a", "a"]',
)  # fmt: skip
# Keys, values and cells: quoted, or up to what ends them.
_WORD = re.compile(r'"(?:[^"\\\n]|\\.)*"|[^\s",=:\[\]{}]+')


def in_words(text: str, rng: random.Random) -> str:
    """Return JSON, TOML or CSV with a key, value or cell gone, odd, renamed, wrapped or doubled."""
    words = [*_WORD.finditer(text)]
    one, other = rng.choice(words), rng.choice(words)
    key = one[0].strip('"') + rng.choice(("_", "s", "é"))
    odd, wrapped = rng.choice(ODD), f"[{one[0]}]"
    new = rng.choice(("", odd, odd, f'"{key}"' if one[0][0] == '"' else key, wrapped, other[0]))
    return text[: one.start()] + new + text[one.end() :]


def in_bytes(content: bytes, rng: random.Random) -> bytes:
    """Return bytes with some cut out, put in, doubled or changed."""
    start = rng.randrange(len(content) + 1)
    end = min(len(content), start + rng.choice((1, 3, 50, 100_000)))
    put = rng.choice((b"", bytes(3), rng.randbytes(4), 2 * content[start:end], b'"', b"\n[[x]]\n", b"\xff"))
    return content[:start] + put + content[end:]


def damaged(content: bytes, rng: random.Random) -> bytes:
    """Return a file's content with one of its words or some of its bytes changed."""
    if rng.random() >= 0.15:
        with suppress(UnicodeDecodeError, IndexError):  # no text, or no word in it
            return in_words(content.decode(), rng).encode()
    return in_bytes(content, rng)
