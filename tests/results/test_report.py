"""The report: one well-formed page that loads nothing, says all that the datasets say, and trusts no text."""

import base64
import json
import math
import re
import xml.etree.ElementTree as ET
from collections import Counter
from functools import cache
from html import escape, unescape
from html.parser import HTMLParser
from urllib.parse import urlsplit

import attrs
import pytest
import xarray as xr
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath

import rollslip
from coarse import COARSE
from rollslip.bearing.assembly import assemble
from rollslip.references import KLEBANOV, as_dict
from rollslip.results.accounts import answer as answer_of
from rollslip.results.curves import percent
from rollslip.results.figures import save_plots
from rollslip.results.report import _accuracy, write_report
from rollslip.results.style import on_dark
from rollslip.results.text import OTHER_BOUNDS, describe_more_bounds
from rollslip.scene import resolved
from rollslip.scene.reading import load_scene
from rollslip_studies.effective_friction.study import EffectiveFriction
from rollslip_studies.friction_curve.study import FrictionCurve

SCENE = load_scene("1032930-30C")
HOSTILE = "<script>alert('1')</script> & \"quoted\" <b>bold</b> $title"
VOID = {"meta", "br"}


def provenance(**changes):
    """Return the attributes of a result, short and all different, so that each is found on the page."""
    return {
        "title": "A bearing & its slip",
        "description": "What <i>it</i> is about.",
        "source": "some-scene.toml",
        "scene": 'title = "x"  # <verbatim> & so on',
        "scene_resolved": json.dumps(resolved(SCENE)),
        "scene_hash": "0123abcd" * 8,
        "packages": json.dumps({"rollslip": "7.8.9", "numpy": "2.0.1"}),
        "models": json.dumps(
            [
                {
                    "kind": "film",
                    "name": "moes",
                    "package": "some-package",
                    "version": "4.5.6",
                    "equation": "H < M & so on",
                    "references": ["Moes 1992.", "Another 1993."],
                    "parameters": "Moes(a=1)",
                }
            ]
        ),
        "lubricant": json.dumps({"name": "some-oil", "source": "some handbook"}),
        "conditions": json.dumps(
            {
                ring: {"viscosity": 0.0163, "effusivity": 12986.0, "conductivity": float("nan")}
                for ring in ("inner", "outer")
            }
        ),
        "plan": json.dumps(
            [
                {
                    "part": "slices",
                    "included": True,
                    "choice": "profile x",
                    "resolution": "17 slices",
                    "reason": "uneven",
                },
                {
                    "part": "inlet",
                    "included": False,
                    "choice": "none",
                    "resolution": "",
                    "reason": "nobody asked",
                },
            ]
        ),
        "warnings": json.dumps(["mind the load < 2"]),
        "citations": json.dumps(
            ["Klebanov 2022. https://doi.org/10.3103/S1068366622010068", "Moes 1992."]
        ),
        "evaluations": 1234567,
        "wall_time": 1.5,
        "created": "2030-01-02T03:04:05+00:00",
    } | changes


@pytest.fixture(scope="module")
def results():
    assembly = assemble(SCENE)
    return {
        "effective-friction": EffectiveFriction(points=11, map_points=4, per_roller=True).run(
            assembly
        ),
        "friction-curve": FrictionCurve(points=21, normal_force=(300.0, 518.0)).run(assembly),
    }


@pytest.fixture(scope="module")
def figures(results, tmp_path_factory):
    folder = tmp_path_factory.mktemp("figures")
    return {name: save_plots(dataset, folder) for name, dataset in results.items()}


def written(results, figures, folder, **attributes):
    path = folder / "report.html"
    write_report(
        {name: dataset.assign_attrs(attributes) for name, dataset in results.items()}, figures, path
    )
    return path.read_text(encoding="utf-8")


@pytest.fixture
def page(results, figures, tmp_path):
    return written(results, figures, tmp_path, **provenance())


@pytest.mark.slow
def test_the_answer_stands_before_all_else(results, figures, tmp_path):
    page = written(results, figures, tmp_path, **provenance())
    datasets = [dataset.assign_attrs(provenance()) for dataset in results.values()]
    answer = answer_of(*datasets)
    slip, friction = answer.next
    assert friction == "rollslip run some-scene.toml --study friction-curve --report"
    instead = "rollslip uncertainty some-scene.toml"  # a report is there
    at = page.index(attrs.evolve(answer, next=(slip, instead)).html())
    assert f"<strong>{answer.verdict}</strong> " in page[at:]
    assert "some-oil, 6371 rpm, 3.415 kN, 30 °C" in page[at:]
    assert at < page.index('<section id="figures"') < page.index('<section id="warnings"')
    assert page.index('<section id="warnings"') < page.index("<details><summary><h2")
    for row in answer.rows:
        assert f'<th scope="row">{row.label}</th><td>{escape(row.text)}</td>' in page


# The first page -----------------------------------------------------------------------------------------------------

#: Millimetres of a point of type: 72 to the inch.
POINT = 25.4 / 72.0
#: Millimetres of 1 rem: 16 CSS pixels, of which an inch has 96.
REM = 16.0 * 25.4 / 96.0
#: A4 less the margins of @page.
WIDTH = 210.0 - 2 * 15.0
#: The same for its height, margins of 12 mm above and below.
HEIGHT = 297.0 - 2 * 12.0


@cache
def lines_of(text, points, room):
    """Lines of a text in DejaVu Sans, which is wider than the fonts of systems, in a room [mm]."""
    text = unescape(re.sub(r"<[^>]*>", "", text)).replace("$", "").strip()
    font = FontProperties(family="DejaVu Sans", size=points)
    width = TextPath((0, 0), text, prop=font).get_extents().width * POINT if text else 0.0
    return max(1, math.ceil(1.1 * width / room))  # words leave a rest at the end of a line


def height_of(first):
    """Height [mm] of the first page in print, by the lengths of the style sheet."""

    def table(html, room):
        rows = [
            re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row)
            for row in re.findall(r"<tr[^>]*>(.*?)</tr>", html, re.S)
        ]
        fixed = sum(
            max(8.0 * 0.6 * POINT * len(unescape(row[k])) for row in rows)
            for k in range(len(rows[0]) - 1)
        )
        last = max(room - fixed - 4.0, 21.0)
        return sum(lines_of(row[-1], 8.0, last) * 8.0 * 1.4 * POINT + 1.4 + 0.3 for row in rows)

    answer, given = first.split('<div class="given">')
    height = (
        lines_of(re.search("<h1>(.*?)</h1>", first)[1], 15.0, WIDTH) * 15.0 * 1.25 * POINT + 2.0
    )
    for k, paragraph in enumerate(re.findall(r"<p>(.*?)</p>", answer)):
        points = 9.0 if k else 11.0
        count = sum(lines_of(line, points, WIDTH) for line in paragraph.split("<br/>"))
        height += count * points * 1.35 * POINT + 3.0
    drawing = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', given)
    figure = 88.0 * float(drawing[2]) / float(drawing[1]) + 8.0 + 0.5 * REM
    figure += (
        lines_of(re.search("<figcaption>(.*?)</figcaption>", given)[1], 8.0, 88.0)
        * 8.0
        * 1.35
        * POINT
    )
    return height + table(answer, WIDTH) + REM + max(figure, table(given, 80.0) + 1.5 * REM)


@pytest.fixture(scope="module")
def skidding(tmp_path_factory):
    """A scene with all rows, its page, and the part of it that is to fill one sheet."""
    folder = tmp_path_factory.mktemp("skidding")
    scene = rollslip.new(
        "NU 2312", oil="iso-vg-220", speed="1500 rpm", load="1 kN", temperature="70 degC"
    )
    result = rollslip.run(
        rollslip.evolve(scene, COARSE | {"accuracy.slices": 5}, si=True), "steady-slip"
    )
    assert len(answer_of(result).visible_rows()) == 8
    figures = save_plots(result, folder)

    def page(**attributes):
        known = result.assign_attrs(attributes)
        write_report(
            {"steady-slip": known},
            {"steady-slip": figures},
            folder / "report.html",
        )
        html = (folder / "report.html").read_text(encoding="utf-8")
        return html, html[html.index('<div class="first">') : html.index("</header>")]

    return result, page


def test_the_first_page_has_verdict_rows_inputs_one_figure_and_notes_and_all_else_is_behind_it(
    skidding,
):
    result, page = skidding
    html, first = page()
    answer = answer_of(result)
    assert answer.html() in first
    assert first.count("<figure>") == 1
    assert "driving torque of the rollers" in first
    assert all(f"{note.code} {escape(note.short)}" in first for note in answer.notes)
    assert '<th scope="row">load</th><td data-of="value">1 kN</td>' in first
    assert html.count("Figure 1. ") == 1
    printed = html[html.index("@media print { body") :]
    assert ".first:has(.answer) { break-after: page; }" in printed
    assert "section:has(> details:not([open])) { display: none; }" in printed


@pytest.mark.slow
def test_the_first_page_is_one_sheet_of_a4_also_with_all_notes_and_assumptions(skidding):
    _, page = skidding
    _, first = page()
    assert 130.0 < height_of(first) < HEIGHT
    longest = "traction 'maxwell-eyring' (pressure exponent ln(eta/eta0) <= 1; 94 % outside)"
    told = [
        {"law": f"law {k}", "made_for": "x", "code": f"W{k:02}", "severity": 1.0, "text": "", "short": longest,
         "is_warning": False, "measured": False}
        for k in range(12)
    ]  # fmt: skip
    title = "Bearing NU 2312 of the second stage of a gearbox, as it runs in spring at 70 degC in ISO VG 220, idle"
    html, full = page(validity=json.dumps({"messages": told}), title=title)
    assert full.count(longest.replace("<", "&lt;").replace("'", "&#x27;")) == 8
    assert title.replace("degC", "°C") in html
    assert height_of(first) + 20.0 < height_of(full) < HEIGHT


def test_letters_of_figures_are_9_pixels_high_on_a_phone_or_the_page_says_scroll(skidding):
    """Of 390 px the margins take 32; the smallest letters are those of 6.5 pt in `rollslip.results.curve_figures`."""
    html, _ = skidding[1]()
    assert "@media screen and (max-width: 46rem)" in html
    seen = []
    for figure in re.findall(r"<figure.*?</figure>", html, re.S):
        width = float(re.search(r'viewBox="0 0 ([\d.]+)', figure)[1])
        least = re.search(r'class="wide-one" style="--min-width: (\d+)px"', figure)
        size = min(
            float(one)
            for one in re.findall(r"font(?:-size)?: ?([\d.]+)px", figure)
            if float(one) >= 6.0
        )
        assert size * (float(least[1]) if least else 390.0 - 32.0) / width >= 9.0
        seen.append(bool(least))
    assert {*seen} == {True, False}
    assert '.wide-one .sheet::before { content: "scroll sideways' in html


def test_bounds_of_less_consequence_are_folded_below_the_warnings(results, figures, tmp_path):
    told = [
        {"law": f"law {k}", "made_for": "x < 1", "severity": 1.0 / k, "text": f"sentence {k}", "short": f"short {k}",
         "is_warning": k < 6, "measured": False}
        for k in range(1, 7)
    ]  # fmt: skip
    warnings = json.dumps(
        ["mind the load", *(f"sentence {k}" for k in range(1, 6)), f"{OTHER_BOUNDS} small: short 6"]
    )
    said = provenance() | {"warnings": warnings, "validity": json.dumps({"messages": told})}
    page = written(results, figures, tmp_path, **said)
    top, folded = (
        page[page.index('<section id="warnings"') :].split("</section>")[0].split("<details>")
    )
    assert re.findall("<li>(.*?)</li>", top) == [
        "mind the load",
        "sentence 1",
        "sentence 2",
        "sentence 3",
    ]
    assert re.findall("<li>(.*?)</li>", folded) == ["sentence 4", "sentence 5", "sentence 6"]
    assert "<summary>3 more bounds of laws are left" in folded
    assert describe_more_bounds(["short 1"]).startswith("1 more bound of a law is left, ")


class Page(HTMLParser):
    """What a browser sees: elements with their attributes, and the text of each section."""

    def __init__(self, html):
        super().__init__()
        self.elements = []
        self.open = []
        self.text = ""
        self.feed(html)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def test_it_is_well_formed_html_and_xml(page):
    assert page.startswith("<!DOCTYPE html>")
    assert Page(page).elements[0] == (
        "html",
        {"lang": "en", "xmlns": "http://www.w3.org/1999/xhtml"},
    )
    ET.fromstring(page)


def test_it_has_no_script_and_loads_nothing(page):
    elements = Page(page).elements
    assert not {tag for tag, _ in elements} & {
        "script",
        "link",
        "img",
        "image",
        "iframe",
        "object",
        "embed",
        "base",
    }
    for tag, attributes in elements:
        for name, value in attributes.items():
            assert not name.startswith("on")
            if name in ("src", "href", "xlink:href", "srcset", "data", "action") and not (
                tag == "a"
                # which a reader has to follow, or to save
                and value.startswith(("https://doi.org/10.", "data:text/plain;"))
            ):
                assert value.startswith("#"), (tag, name, value)
    assert not re.search(r"@import|url\((?!#)", page)
    assert not re.search(r"https?:", page.split("<style>")[1].split("</style>")[0])
    policy = next(
        a["content"] for t, a in elements if a.get("http-equiv") == "Content-Security-Policy"
    )
    assert policy.startswith("default-src 'none'")


def test_addresses_are_only_namespaces_text_and_dois(page):
    for attributes in (attributes for _, attributes in Page(page).elements):
        for name, value in attributes.items():
            if urlsplit(value or "").scheme in ("http", "https"):
                assert name.startswith("xmlns") or (
                    name == "href" and value.startswith("https://doi.org/10.")
                )


def test_ids_are_unique_and_every_reference_has_its_target(page):
    ids = Counter(attributes["id"] for _, attributes in Page(page).elements if "id" in attributes)
    assert max(ids.values()) == 1
    targets = set(re.findall(r'href="#([^"]+)"', page)) | set(re.findall(r"url\(#([^)]+)\)", page))
    assert len(targets) > 20
    assert targets <= set(ids)


def test_every_figure_has_a_caption_and_a_label(page, figures):
    number = sum(map(len, figures.values()))
    assert number == 4
    drawings = [attributes for tag, attributes in Page(page).elements if tag == "svg"]
    assert len(drawings) == page.count("<figcaption>") == number
    for drawing in drawings:
        assert drawing["role"] == "img"
        assert "ring" in drawing["aria-label"]
        assert drawing["viewbox"]
        assert not {"width", "height"} & set(drawing)
    assert (
        "Figure 3. Friction of one contact with the inner ring, entrainment speed 29.8 m/s." in page
    )


def test_tables_have_headers(page):
    root = ET.fromstring(page)
    space = "{http://www.w3.org/1999/xhtml}"
    tables = list(root.iter(f"{space}table"))
    assert len(tables) >= 8
    for table in tables:
        assert {cell.get("scope") for cell in table.find(f"{space}thead").iter(f"{space}th")} == {
            "col"
        }
        for row in table.find(f"{space}tbody"):
            assert row[0].get("scope") == "row"
            assert len(row) == len(table.find(f"{space}thead")[0])


def test_it_says_what_was_found(page, results):
    text = Page(page).text
    for ring in ("inner", "outer"):
        value = float(results["effective-friction"].critical_cage_slip.sel(ring=ring))
        assert f"{ring.capitalize()} ring: cage slip at largest traction {percent(value)}" in text
    for force, value in zip(
        ("300 N", "518 N"), results["friction-curve"].critical_slip.values, strict=True
    ):
        assert (
            f"{force}: slip at largest traction {percent(value)}, friction coefficient there"
            in text
        )


def test_it_says_in_words_that_there_is_no_critical_slip(figures, tmp_path):
    flat = FrictionCurve(points=11, max_slip=1e-3).run(assemble(SCENE))
    text = Page(written({"friction-curve": flat}, {}, tmp_path)).text
    assert (
        "no slip at largest traction: friction still rises at the end of the range, 0.001; look further"
        in text
    )
    assert "--set study.friction-curve.max_slip=0.01" in text
    assert "In this range the friction coefficient reaches" in text


@pytest.mark.parametrize(
    "words",
    [
        "A bearing & its slip",
        "What <i>it</i> is about.",
        "mind the load < 2",
        "some-scene.toml",
        "0123abcd" * 8,
        "2030-01-02T03:04:05+00:00",
        "7.8.9",
        "some-package 4.5.6",
        "Moes(a=1)",
        "Oil some-oil. some handbook",
        "17 slices",
        "nobody asked",
        "https://doi.org/10.3103/S1068366622010068",
        "1,234,567",
        "bearing.inner_raceway_diameter",
        f"{1e3 * SCENE.bearing.inner_raceway_diameter:g} mm",
        "6371 rpm",
        "30 °C",
        "300 N, 518 N",
        "epicyclic",
        "rigid-piezoviscous",
    ],
)
def test_it_says(page, words):
    assert words in Page(page).text


def test_steel_and_oil_in_the_contacts_are_in_a_file_of_the_page(page):
    (link,) = (a["href"] for tag, a in Page(page).elements if a.get("download") == "contacts.txt")
    text = base64.b64decode(link.partition("base64,")[2]).decode()
    assert "ambient pressure, 16.3 mPa s, 16.3 mPa s\n" in text
    assert "12986 J/(m2 K s^0.5)" in text


@pytest.mark.slow
def test_a_report_has_at_most_1500_words(tmp_path):
    """Its text without that of figures; also what is folded."""
    rollslip.report(rollslip.run("gearbox"), out=tmp_path / "report.html")
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    body = re.sub(r"<svg.*?</svg>", " ", html[html.index("<body") :], flags=re.DOTALL)
    words = re.sub(r"<[^>]*>", " ", body).split()
    assert 1200 < len(words) <= 1500


def test_what_all_say_alike_is_said_once(page):
    text = Page(page).text
    for words in (
        "mind the load < 2",
        "nobody asked",
        "some handbook",
    ):
        assert text.count(words) == 1
    assert text.count("as it was written") == 1


def test_a_citation_that_is_data_has_its_doi_as_a_link(results, figures, tmp_path):
    hostile = attrs.evolve(KLEBANOV, title=HOSTILE, doi="10.1234/<a>&(b)")
    data = json.dumps([as_dict(KLEBANOV), as_dict(hostile), "Moes 1992."])
    page = written(results, figures, tmp_path, **provenance(bibliography=data))
    links = [
        a["href"] for tag, a in Page(page).elements if tag == "a" and a["href"].startswith("https")
    ]
    assert links == [
        "https://doi.org/10.3103/S1068366622010068",
        "https://doi.org/10.1234/%3Ca%3E%26(b)",
    ]
    assert str(KLEBANOV) in Page(page).text
    assert "Klebanov 2022." not in Page(page).text  # the data stand for the texts
    test_it_has_no_script_and_loads_nothing(page)
    test_addresses_are_only_namespaces_text_and_dois(page)


def test_what_differs_is_said_of_each(results, figures, tmp_path):
    both = {
        name: dataset.assign_attrs(
            provenance(title=name, warnings=json.dumps([f"warning of {name}"]), source=f"{k}.toml")
        )
        for k, (name, dataset) in enumerate(results.items())
    }
    path = tmp_path / "report.html"
    write_report(both, figures, path)
    text = Page(path.read_text()).text
    assert "Results of rollslip" in text
    for k, name in enumerate(results):
        assert f"warning of {name}" in text
        assert f"{k}.toml ({name})" in text


def test_texts_of_users_are_escaped(results, figures, tmp_path):
    lists = {"warnings": [HOSTILE], "citations": [HOSTILE], "packages": {HOSTILE: HOSTILE}}
    model = ("kind", "name", "package", "version", "equation", "parameters")
    tables = {
        "models": [dict.fromkeys(model, HOSTILE) | {"references": [HOSTILE]}],
        "plan": [
            {**dict.fromkeys(("part", "choice", "resolution", "reason"), HOSTILE), "included": True}
        ],
        "lubricant": {"name": HOSTILE, "source": HOSTILE},
        "conditions": {HOSTILE: {"viscosity": HOSTILE}},
        "scene_resolved": {
            HOSTILE: {HOSTILE: HOSTILE, "list": [{"a": HOSTILE}, {"a": [HOSTILE, True]}]}
        },
    }
    plain = dict.fromkeys(
        ("title", "description", "source", "scene", "scene_hash", "created", "closure"), HOSTILE
    )
    attributes = provenance(
        **plain, **{key: json.dumps(value) for key, value in (lists | tables).items()}
    )
    named = {HOSTILE: results["effective-friction"]}
    html = written(named, {HOSTILE: figures["effective-friction"]}, tmp_path, **attributes)
    page = Page(html)
    assert not {tag for tag, _ in page.elements} & {"script", "b"}
    assert page.text.count(HOSTILE) > 25
    ET.fromstring(html)


@pytest.mark.slow
def test_captions_are_escaped(results, tmp_path):
    hostile = results["effective-friction"].assign_attrs(closure=HOSTILE)
    html = written({"e": hostile}, {"e": save_plots(hostile, tmp_path)}, tmp_path)
    assert not {tag for tag, _ in Page(html).elements} & {"script", "b"}
    assert HOSTILE in Page(html).text
    ET.fromstring(html)


@pytest.mark.parametrize("missing", [*provenance(), "closure", "n_positions", "ring"])
def test_a_missing_attribute_leaves_its_part_out(results, tmp_path, missing):
    datasets = {name: dataset.assign_attrs(provenance()) for name, dataset in results.items()}
    for dataset in datasets.values():
        dataset.attrs.pop(missing, None)
    html = written(datasets, {}, tmp_path)
    ET.fromstring(html)
    assert 'id="findings"' in html


def test_a_dataset_that_says_nothing_gives_an_empty_page(results, tmp_path):
    bare = results["friction-curve"].copy()
    bare.attrs = {}
    page = Page(written({"a": bare}, {}, tmp_path))
    assert "section" not in {tag for tag, _ in page.elements}


def test_unimportant_values_are_shown_for_what_they_are(results, figures, tmp_path):
    resolved_scene = {
        "plugins": {"require": []},
        "study": {"x": {"on": True, "points": [{"t": 1.25}, {"t": 2.5}]}},
    }
    html = written(
        results, figures, tmp_path, **provenance(scene_resolved=json.dumps(resolved_scene))
    )
    text = Page(html).text
    assert "plugins.require" not in text
    assert "study.x.onyes" in text.replace("\n", "")
    assert "study.x.points.22.5" not in text
    assert "study.x.points.2.t2.5" in text


def test_plan_and_errors_stand_where_their_heads_say(results, figures, tmp_path):
    rows = [
        {
            "result": "friction",
            "tolerance": 1e-3,
            "estimated": 2e-4,
            "found": 5e-4,
            "how": "afterwards",
        }
    ]
    said = provenance(accuracy=json.dumps(rows))
    text = Page(written(results, figures, tmp_path, **said)).text
    places = [
        text.index(one)
        for one in ("Modelled", "profile x", "Left out", "nobody asked", "2.0e-04", "5.0e-04")
    ]
    assert places == sorted(places)


def test_contacts_at_light_load_are_flagged(page, results):
    text = Page(page).text
    fraction = float(results["effective-friction"].light_fraction.sel(ring="inner"))
    assert fraction > 0.0
    assert f"{percent(fraction)} of the force" in text
    assert "at M < 2" in text


def test_the_same_input_gives_the_same_page(results, figures, tmp_path):
    assert written(results, figures, tmp_path, **provenance()) == written(
        results, figures, tmp_path, **provenance()
    )


def test_figures_follow_a_page_that_is_dark(page):
    """Drawings have their own colours, which readers without style sheets show too; each has one on a dark ground."""
    sheet, body = page.split("<style>", 1)[1].split("</style>", 1)
    drawn = set(re.findall(r"(fill|stroke): (#[0-9a-f]{6})", body))
    assert len(drawn) > 5
    _, dark = sheet.split("@media screen and (prefers-color-scheme: dark){figure svg")
    assert all(
        f'[style*="{part}: {colour}"]{{{part}:{on_dark(colour)}!important}}' in dark
        for part, colour in drawn
    )
    assert not re.findall(r"(fill|stroke)(?:=|: var)", body)


def test_what_a_reader_may_open_is_reached_by_the_contents(page):
    elements = Page(page).elements
    targets = {a["href"] for t, a in elements if t == "a" and a["href"].startswith("#")}
    assert targets <= {f"#{a['id']}" for _, a in elements if "id" in a}
    assert len(re.findall(r"<details><summary><h2", page)) >= 6
    assert "data-of=" in page


@pytest.mark.parametrize("tolerances", [(0.1, 0.1), (0.1, 0.2)])
def test_errors_are_under_the_names_of_their_studies_where_they_differ(tolerances):
    row = {"result": "critical_slip", "estimated": 0.03, "found": None}
    studies = {
        name: xr.Dataset(attrs={"accuracy": json.dumps([row | {"tolerance": tolerance}])})
        for name, tolerance in zip(("steady-slip", "dynamics"), tolerances, strict=True)
    }
    cells = re.findall("<t[dh][^>]*>([^<]*)</t", _accuracy(studies))[4:]
    first, second = (["critical slip", str(tolerance), "3.0e-02", ""] for tolerance in tolerances)
    if first == second:
        assert cells == first
    else:
        of_study = [[name, "", "", ""] for name in studies]
        assert cells == [*of_study[0], *first, *of_study[1], *second]
