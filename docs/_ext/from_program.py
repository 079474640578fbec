"""The directive ``from-program``: what the program itself knows of its documentation, so that it cannot go stale.

``.. from-program:: PART [ARGUMENT]`` takes a part of `facts.PARTS`, which returns lines of reStructuredText.
"""

import facts
from sphinx.util.docutils import SphinxDirective


class FromProgram(SphinxDirective):
    required_arguments = 1
    optional_arguments = 1

    def run(self):
        part, *rest = self.arguments
        if part == "table":
            self.env.note_dependency(str(facts.ROOT / "docs" / "tables" / f"{rest[0]}.csv"))
            self.env.note_dependency(facts.__file__)
        else:
            self.env.note_reread()
        return self.parse_text_to_nodes(
            "\n".join(facts.PARTS[part](*rest)), allow_section_headings=True
        )


def setup(app):
    app.add_directive("from-program", FromProgram)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
