"""Equations as MathML, by the converter that comes with docutils."""

import re

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml

#: A letter with an index and a dot or a bar, as the converter writes it: with the index below.
ACCENTED = re.compile(
    r'<munderover>\s*(<mi>[^<]*</mi>)\s*(.*?)\s*(<mo stretchy="false">[\u02d9\u00af\u02c9^~]</mo>)\s*</munderover>',
    re.DOTALL,
)


def converted(text, **options):
    """Return MathML; browsers leave no room after a function, and few fonts have the modifier letter for a bar."""
    made = ACCENTED.sub(
        r'<msub><mover accent="true">\1\3</mover>\2</msub>', tex2mathml(text, **options)
    )
    return made.replace("<mo>&ApplyFunction;</mo>", '<mspace width="0.15em"/>').replace(
        "\u02c9", "\u00af"
    )


def inline(translator, node):
    translator.body.append(converted(node.astext()))
    raise nodes.SkipNode


def parts(text):
    """A display of several equations, cut where it leaves a gap between them, so that narrow pages can stack them.

    One whose rows are aligned stays whole.
    """
    made = []
    depth = 0
    start = 0
    for gap in re.finditer(
        r"&|\\q?quad(?![a-z])|\\(?:begin|left)(?![a-z])|\\(?:end|right)(?![a-z])|\\.|[{}]", text
    ):
        word = gap.group()
        if word == "&" and not depth:
            return [text]
        if word.endswith("quad") and not depth:
            made.append(text[start : gap.start()].strip())
            start = gap.end()
        depth += (word in ("{", r"\begin", r"\left")) - (word in ("}", r"\end", r"\right"))
    return [*filter(None, made), text[start:].strip()]


def block(translator, node):
    equations = "".join(converted(part, as_block=True) for part in parts(node.astext()))
    translator.body.append(f'<div class="equation">{equations}</div>')
    raise nodes.SkipNode


def setup(app):
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
