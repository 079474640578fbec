"""Designations of bearings in any spelling: type, size, cage and clearance of cylindrical roller bearings, and others.

A designation is read from the left: a maker or none, the type, series and code of the bore, then what stands behind
them, in any spelling: "SKF NU 205 ECP/C3", "nu205-e-xl-tvp2-c3", "NU205.E.M1.C3", "NU205ETVP2C3". What is not known
behind the number is not ignored: the designation is then unknown, and the message names the part. Letters in other
forms (full width) are read as Latin ones by NFKC; those of other alphabets, which only look alike, are unknown.

- Letters of the cage (SKF, Schaeffler, NKE, NSK, NTN, SNR, Koyo, Nachi, ZVL, URB; C) say what it is of and what guides
  it. Behind M, M1 and M6 stands a cage of two parts on the rollers, MA, MPA on the outer and MB, MPB on the inner ring;
  ML and MP are on the ring that has the ribs. PEEK (PH) is none of the makes here, and has no effect.
- C2, CN, C3, C4, C5 are the groups of ISO 5753-1, the same for all makers. L, M, H behind one are its lower half,
  its middle and its upper half (SKF; C); behind a space M is a cage: "C4 M". P63 is class P6 with C3. NSK's CC and CM,
  NA, ranges in um (R40) and tapered bores (K) are other clearances, and are not read.
- HC5 is a hybrid bearing, whose rollers are ceramic (SKF, Schaeffler; C), and is not read; nor is "ECPHC5", which may
  also be a cage of PEEK (PH) and C5.
- Other bearings are recognised by the first digits of their number (ISO 15 with the common scheme of makers, DIN 623-1;
  C).
"""

import re
import unicodedata
from collections.abc import Mapping
from typing import Final, NamedTuple

from rollslip.datasets import OwnCage

__all__ = ["Designation", "other_bearing", "packed", "read_designation"]

#: Makers and words before and after a designation.
_SURROUNDINGS: Final = (
    "SKF|FAG|INA|SCHAEFFLER|NSK|NTN|SNR|KOYO|JTEKT|NACHI|NKE|TIMKEN|FAFNIR|TORRINGTON|URB|ZKL|ZVL|KINEX|RHP|STEYR|"
    "FERSA|ISB|FBJ|KBC|LYC|ZWZ|HRB|CRAFT|MPZ|EPK|GPZ|PSL|MRC|IBC|FKL|NBS|CX|CODEX|ROLLWAY|NRB|SLF|EXPLORER|"
    "CYLINDRICAL|ROLLER|BALL|BEARINGS?|ZYLINDERROLLENLAGER|W(?:AE|Ä)LZLAGER|DIN ?5412(?:-1)?|TYPE|SINGLE|ROW|CRB"
)
#: Makers and words before a designation.
_BEFORE_DESIGNATION: Final = re.compile(
    rf"^(?:[\s\-:,./]*(?:{_SURROUNDINGS})\b)*(?:[\s\-:,./]*(?:{_SURROUNDINGS})(?=[A-Z]*\d))?[\s\-:,./]*"
)
#: Makers and words after a designation.
_AFTER_DESIGNATION: Final = re.compile(rf"(?:[\s\-:,./(\[]+(?:{_SURROUNDINGS})[\s)\]]*)+$")
#: Letters -> material of the cage, and what guides it; "ribs" is the ring that has them.
_CAGES: Final[Mapping[str, tuple[str, str]]] = {
    **dict.fromkeys(
        ("P", "TVP", "TVP2", "TVP3", "TVPX", "TN", "TN9", "TNG", "T", "T2", "T2X", "G15", "G"),
        ("polyamide", "roller"),
    ),
    **dict.fromkeys(("PA", "TVPA"), ("polyamide", "outer")),
    **dict.fromkeys(("TVPB",), ("polyamide", "inner")),
    **dict.fromkeys(("J", "JP", "JP1", "JP3", "W"), ("steel", "roller")),
    **dict.fromkeys(("M", "M1", "M6", "MR", "MY", "FY", "FG", "G1", "L1"), ("brass", "roller")),
    **dict.fromkeys(("MA", "M1A", "MA6", "MPA", "MP1A", "MAS"), ("brass", "outer")),
    **dict.fromkeys(("MB", "M1B", "MB6", "MPB", "MP1B"), ("brass", "inner")),
    **dict.fromkeys(("ML", "MP"), ("brass", "ribs")),
}
#: Letters without effect on the model: PEEK, precision, heat treatment, insulation, special versions, interchange.
_SILENT: Final = (
    "P[0456]|S[0-4]|SN|W\\d{2,3}|L4B|L5B|V[ACEQL]\\d{3,4}|J20[A-Z]{0,2}|F1|FV|AH|XL|W33|Q"
)
#: Letters of cages, the longest first.
_CAGE: Final = "|".join(sorted(_CAGES, key=len, reverse=True))
#: A class of clearance stands behind the cage or, with some, before it; SNR's J30 is C3.
_TAIL: Final = re.compile(
    rf"(?P<design>OLD|EC|EA|EXL|E|R)?(?:XL)?(?P<first>C[2345N][LMH]?)?(?:(?P<cage>{_CAGE})|(?P<peek>PHA?S?))?"
    rf"(?P<before>(?:{_SILENT})*?)(?P<group>C[2345N][LMH]?|J[34]0)?(?P<after>(?:{_SILENT})*)"
)
#: Class of tolerances and group of clearance in one, P63 for P6 and C3 (ISO 492 with ISO 5753-1; C).
_CLASS_AND_GROUP: Final = re.compile(r"P([456])([2345])(?!\d)")
#: Group of clearance before the letters of a brass cage, which a space parts.
_GROUP_BEFORE_CAGE: Final = re.compile(r"(C[2345N])[\s\-./]+(M\w*|L1)\b")
#: Ceramic rollers; PHC5 may also be PEEK and C5, PH/C5 is not found.
_HYBRID: Final = re.compile(r"HC\d")
#: Type, series and code of a cylindrical roller bearing.
_NUMBER: Final = re.compile(
    r"(?P<type>NUP|NU|NJ|N)(?P<series>10|22|23|2|3|4)(?P<code>\d\d)(?!\d)(?P<tail>.*)"
)


class Designation(NamedTuple):
    """Type, size, cage and clearance of a cylindrical roller bearing by its designation."""

    #: type, series, code: "NU", "22", "10" of an NU 2210 ECP/C3.
    type: str
    series: str
    code: str
    reinforced: bool  # whether it names the reinforced type E
    old: bool  # whether it names the type before that
    cage: OwnCage | None  # cage by its letters
    group: str | None  # group of clearance, "C3" or "CNL" for example; None without one
    ignored: str = ""  # letters without effect on the model, separated by spaces


def _bare(written: str) -> str:
    """Return a designation in capitals, without makers around it and the angle ring that may come with it."""
    text = unicodedata.normalize("NFKC", written).upper().strip()
    text = _AFTER_DESIGNATION.sub("", _BEFORE_DESIGNATION.sub("", text))
    text = re.sub(r"\s*\+\s*HJ[\s\d.\-]*(?:EC?)?(?![A-Z])", "", text)
    return _GROUP_BEFORE_CAGE.sub(r"\2\1", text)


def packed(written: str) -> str:
    """Return a designation in capitals without makers, spaces and signs; letters of other alphabets stay."""
    return "".join(letter for letter in _bare(written) if letter.isalnum())


def read_designation(written: str) -> Designation | None:
    """Return what a designation means, in any spelling; None if it is not one of a bearing NU, NJ, NUP or N.

    Examples
    --------
    >>> read = read_designation("SKF NU 2210 ECP/C3")
    >>> read.series, read.code, read.cage.make, read.group
    ('22', '10', 'polyamide', 'C3')
    """
    number = _NUMBER.fullmatch(packed(written))
    if number is None or _HYBRID.search(_bare(written)):
        return None
    tail = _TAIL.fullmatch(_CLASS_AND_GROUP.sub(r"P\1C\2", number["tail"]))
    if tail is None or (tail["first"] and tail["group"]):
        return None
    cage = None
    group = tail["first"] or tail["group"]
    if tail["cage"] is not None:
        make, guidance = _CAGES[tail["cage"]]
        ribbed = "inner" if number["type"] == "N" else "outer"
        cage = OwnCage(make, ribbed if guidance == "ribs" else guidance, tail["cage"])
    return Designation(
        number["type"],
        number["series"],
        number["code"],
        tail["design"] in ("E", "EC", "EA", "EXL", "R"),
        tail["design"] == "OLD",
        cage,
        group.replace("J", "C").removesuffix("0") if group else None,
        " ".join(
            filter(None, (tail["peek"], *re.findall(_SILENT, tail["before"] + tail["after"])))
        ),
    )


#: What a tapered bearing is that is none of the catalogue.
_OTHER_TAPER: Final = (
    "tapered roller bearing of a size or a series that is not in the catalogue: state its rollers, contact_angle and "
    "pitch_diameter in [bearing] in place of its name"
)
#: The same of an inch series.
_INCH_TAPER: Final = (
    "tapered roller bearing of inch sizes, which are not in the catalogue: state its rollers, contact_angle and "
    "pitch_diameter in [bearing] in place of its name"
)
#: Series of other bearings, the digits before the code of the bore -> kind of bearing.
_SERIES: Final[Mapping[str, str]] = {
    series: what
    for what, every in {
        "deep groove ball bearing": "6 60 62 63 64 68 69 160 161 617 618 619 622 623 628 630 632 633 638",
        "double row deep groove ball bearing": "42 43",
        "self-aligning ball bearing": "1 10 12 13 14 22 23 112 113 115",
        "angular contact ball bearing": "7 70 72 73 74 78 79 718 719",
        "double row angular contact ball bearing": "30 32 33 38 52 53 54",
        "spherical roller bearing": "213 222 223 230 231 232 233 238 239 240 241 248 249",
        "barrel roller bearing": "202 203 204",
        _OTHER_TAPER: "302 303 313 320 322 323 329 330 331 332",
        "thrust ball bearing": "511 512 513 514 522 523 524 532 533 534 542 543 544",
        "double direction angular contact thrust ball bearing": "2344 2347",
        "spherical roller thrust bearing": "292 293 294",
        "cylindrical roller thrust bearing": "811 812 874 893 894 895",
    }.items()
    for series in every.split()
}
#: Pattern of the start of other designations with letters, and kind of bearing; the first that matches counts.
_LETTERED: Final = tuple(
    (re.compile(rf"(?:{start})"), what)
    for start, what in (
        (r"NN[UC]?\d|NNU\d", "double row cylindrical roller bearing"),
        (
            r"NCF|NJG|NNC|NNF|SL0?\d|RSL|NUPV?\d+V|N[UJ]\d+V",
            "full complement cylindrical roller bearing",
        ),
        (r"RNU?\d|RNJ\d|RNUP\d", "cylindrical roller bearing without one of its rings"),
        (r"HJ\d|NH\d|NUJ\d", "cylindrical roller bearing with an angle ring, or the angle ring"),
        (r"L?L?RJ\d|M?MRJ\d|CRM\d|CRL\d", "cylindrical roller bearing of inch sizes"),
        (
            r"R?NA[OX]?\d|NK[ISXR]?|NKI[ABS]|H[KFN]L?\d|BK\d|K\d+X|AXK|NX\d|DL\d|IR\d",
            "needle roller bearing",
        ),
        (r"KRV?E?\d|N[UA][KT][RV]|PWKR|R?STO\d|CF\d", "track roller"),
        (
            r"U[CKE]L?[PFT]?\d|UCF[LC]\d|S[AB]\d|YA[RT]|YE[TL]|GRAE|RAE|G[EY]E?\d+KRR|GYE?\d",
            "insert bearing",
        ),
        (
            r"GE[HGZ]?\d|GI?[AEX]?K?[RL]?\d|G[AI]\w*\d|S[AI]L?\w?\d|GX\d",
            "spherical plain bearing or rod end",
        ),
        (r"QJF?\d", "four-point contact ball bearing"),
        (r"C\d{4}", "toroidal roller bearing"),
        (
            r"K?J?L?H?[LHM]M?\d{5,6}|J[LHMWF]M?\d|HH\d|EE\d",
            _INCH_TAPER,
        ),
        (r"T\d[A-Z]{2}\d|(?:4T|ET|HR|TR)\d", _OTHER_TAPER),
        (r"LM\d+UU|LME?\d|LB[BCE]R?\d|KH\d", "linear ball bearing"),
    )
)
#: Letters before a number that do not change the kind of bearing: hybrid, stainless, coated, for spindles.
_BEFORE: Final = re.compile(
    r"(?:E2|BB1|HCB|HCS|XCB|HSS|HC|HS|SS|S|W|B|4T|ET|HR|TR)[\s.\-]*(?=\d{3})"
)
#: Series and code of a number.
_CORE: Final = re.compile(
    r"(?P<series>\d+?)(?P<code>\d\d|/\d+)(?=[^\d/]|/(?!\d{1,3}\b)|2(?:RS|Z|RZ|LS)|$)"
)


def other_bearing(written: str) -> str | None:
    """Return what a designation is of that is none of the catalogue, in words; None where that is not known.

    Examples
    --------
    >>> other_bearing("SKF 6205-2RS1/C3")
    'a deep groove ball bearing'
    """
    bare = _bare(written)
    solid = packed(written)
    if (number := _NUMBER.fullmatch(solid)) is not None:
        shown = f"{number['type']}{number['series']}{number['code']}"
        if read_designation(written) is not None:  # the nearest size is a better answer
            return None
        if _HYBRID.search(_bare(written)):
            return (
                f"{shown} with ceramic rollers (HC5), or with PEEK and C5, which is written PH/C5"
            )
        return f"a cylindrical roller bearing {shown}, but what {number['tail']!r} behind that means is not known here"
    plain = _BEFORE.sub("", bare, count=1) if _BEFORE.match(bare) else bare
    core = _CORE.match(re.sub(r"(?<=\d)\s(?=\d\d\b)", "", plain))
    what = None if core is None else _SERIES.get(core["series"])
    if re.match(r"\d{4,6}[A-Z]?[/-]\d{4,6}", plain):
        what = _INCH_TAPER  # cone and cup of inch sizes, 15101/15245
    what = what or next((what for start, what in _LETTERED if start.match(solid)), None)
    if what is None and re.match(r"N(?:UP?|JP?|F|P)?\d", solid):
        what = (
            "cylindrical roller bearing of a size or a series that is not in the catalogue: state its rollers and "
            "raceways in [bearing] in place of its name"
        )
    return what and f"a{'n' * (what[0] in 'aeiou')} {what}"
