"""Words that grew inside of the program, and those of the field that stand in their place."""

import re

#: What is not said -> what is said instead.
WORDS = {
    r"\b(the|a|no) cage (runs|run|ran) away|\brunning away\b|\bnothing runs away\b": "skidding",
    r"could carry .* times the drag": "drag reserve",
    r"\bleast (radial )?loads?\b": "minimum load",
    r"\bmakers? (of bearings )?asks? for": "catalogue minimum load",
    r"both rings pull alike|at their epicyclic spin": "balance of moments; pure rolling",
    r"\bcritical (cage )?slips?\b": "slip at largest traction",
    r"how far to trust|\bnot told here\b": "confidence",
    r"\b(was|were|are) made for\b": "valid for",
    r"100 % of the contact force": "all loaded contacts",
    r"\bheld against\b": "checked against",
    r"\bgrades? [A-D]\b": "data quality",
    r"\binstants (of a|within a roller) pitch\b": "roller positions",
    r"\blaminae?\b": "slices",
    r"\bcannot be told\b|\bpoints (were )?judged\b": "determined; checked",
    r"\bgoes one way\b|\bspeaks? for\b": "is monotonic; suggests",
}
#: Names in results and keys, which stay, and what authors of packages read; as they do kernels' errors.
STAYS = {"critical slip", "critical slip{label}", "closure: what the rollers spin at"}
#: Words that a page may use, as it says what they mean: the paper's.
OF_THE_PAPER = r"\bcritical (cage )?slips?\b"


def dialect(text, words=WORDS):
    """What a text should not say, without its gaps, its comments and names as they are typed."""
    bare = re.sub(r"\{[^{}]*(?:\{[^{}]*\}[^{}]*)*\}|``[^`]*``", " ", " ".join(text.split()))
    return [found[0] for word in words for found in re.finditer(word, bare, re.IGNORECASE)]
