"""Equations as MathML, by the converter that comes with docutils."""

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml


def converted(text, **options):
    """Return MathML; browsers leave no room after a function, and few fonts have the modifier letter for a bar."""
    made = tex2mathml(text, **options)
    return made.replace("<mo>&ApplyFunction;</mo>", '<mspace width="0.15em"/>').replace("\u02c9", "\u00af")


def inline(translator, node):
    translator.body.append(converted(node.astext()))
    raise nodes.SkipNode


def block(translator, node):
    translator.body.append(f'<div class="equation">{converted(node.astext(), as_block=True)}</div>')
    raise nodes.SkipNode


def setup(app):
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
