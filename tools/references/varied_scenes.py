"""Numbers of the default answer against a four times finer one, on random scenes of all kinds; varied_scenes.csv.

    python tools/references/varied_scenes.py [SCENES [SECONDS [FIRST]]]

Scenes are those of tests/support/varied_scenes.py: what bends, is not round, tilts, turns backwards or on a carrier.
Each is asked where the cage runs (study steady-slip), with the defaults of `rollslip.new`. Numbers, the finer run and
the second look at close verdicts are those of accuracy_scenes.py, with two differences.

- A number may be off by its own stated error, not by the largest of all numbers.
- Numbers with play in the pockets are held against the finer run, too, beside those of rollers set in the cage.

A scene is *kept* if each number is within the tolerance or its stated error, *stated* if the answer says that a number
which is off is off, or not known, *silent* if nothing says so, *refused* with the words of the refusal, *crash* if it
ends in another error than one of rollslip, *no reference* if the finer run is refused, and *kept within the time: not
known* if the finer run takes more than 60 s of the processor.
A row is written as soon as it is known, and the script goes on where it was interrupted.
"""

import csv
import json
import re
import signal
import sys
import time
from collections import Counter
from pathlib import Path

import accuracy_scenes as accuracy
import numpy as np

import rollslip
import varied_scenes as scenes  # of tests/support, whose path accuracy_scenes adds
from rollslip.bearing.assembly import assemble
from rollslip.bearing.resolution import Resolution
from rollslip.errors import RollslipError
from rollslip.planning.plan import plan
from rollslip.results.text import Status

STUDY = "steady-slip"
#: Time of the processor for a default run, and for a finer one [s]; of a run that is called slow.
LONGEST = 300.0
SECONDS = 60.0
SLOW = 25.0
#: Number -> name under which a result states its error.
STATED = {"largest drag": "limit drag torque", "slip of the largest drag": "skidding slip"}
#: Numbers that play in the pockets changes.
WITH_PLAY = {
    "cage slip": ("steady_slip", 1e-3),
    "minimum load": ("minimum_load", None),
    "reserve to slipping": ("acceptable_reserve", 0.0),
    "reserve to skidding": ("drag_reserve", 0.0),
    "largest drag": ("limit_drag", 0.0),
}
#: Largest reserve that an answer shows.
LARGEST = {"reserve to slipping": 1e3, "reserve to skidding": 1e3}
#: Words of warnings on a number that is off, or not known.
SAID = (" errs by ", " is off ", "error is not known", "leave a relative error")
NOT_KNOWN = "not known in 60 s"
HEADER = [
    *("scene", "what", "category", "number", "off over allowed", "allowed", "slices", "positions"),
    *("verdict", "seconds", "seconds of the reference", "words"),
]
#: What scenes have in particular -> pattern of their description.
KINDS = {
    "all": "",
    "full complement": r"^(NCF|NJG|SL)",
    "needles": r"^(HK|NK)",
    "tapered": r"^3",
    "axial load": r"[1-9]\S* N axial",
    "a tilt": r"tilt (?!0\.00)",
    "preload": r"clearance -",
    "rings that bend": r" ring (annulus|thin)",
    "rings that are not round": r" lobes ",
    "both rings turning": r" and (?!0 rpm)\S+ rpm",
    "a carrier": r"carrier",
    "an own oil": r"own oil",
}
SUMMARY = Path(__file__).parents[2] / "docs" / "tables" / "varied_scenes.csv"


def numbers(result):
    """Numbers of a result; those with play beside those of rollers that are set in the cage."""
    found = accuracy.numbers(result)
    weight = float(result.attrs["rollers_weight"])
    if str(result["minimum_load_status"].item()).startswith(
        (Status.NO_LOAD_NEEDED, Status.ANY_LOAD)
    ):
        found["minimum load"] = weight  # as one that is less than that
    if "slip_without_play" not in result:
        return found
    for name, (variable, low) in WITH_PLAY.items():
        value = float(
            result[variable].min() if "steady" in result[variable].dims else result[variable]
        )
        low = weight if low is None else low
        if name == "minimum load" and np.isnan(value):
            value = found[name]
        if value >= -low:
            value = min(max(value, low), LARGEST.get(name, np.inf))
        found[f"{name}, play"] = value
    return found


def compared(result, exact, tolerance):
    """The number that is off most: its name, over what it may be, what it may be, and the category."""
    stated = {
        row["result"]: row["found"] or row["estimated"] or 0.0
        for row in json.loads(result.attrs["accuracy"])
    }
    said = [
        text for text in json.loads(result.attrs["warnings"]) if any(word in text for word in SAID)
    ]
    values = numbers(result)
    references = numbers(exact)
    unknown = ()
    if accuracy.UNSETTLED[0] in str(exact.get("skidding_status", "")):
        unknown = accuracy.UNSETTLED[1:]
    worst = ("", -1.0, 0.0)
    for name, value in values.items():
        plain = name.partition(",")[0]
        if plain in unknown:
            continue
        key = STATED.get(plain, plain)
        own = float(result[accuracy.CLAIMS[plain]]) if plain in accuracy.CLAIMS else 0.0
        allowed = np.nanmax([tolerance, stated.get(key, 0.0), own])
        off = accuracy.apart(value, references[name]) / allowed
        if off > worst[1]:
            worst = (name, off, allowed)
    name = STATED.get(worst[0].partition(",")[0], worst[0].partition(",")[0])
    # a value that the answer has not found is stated as such
    named = np.isnan(values[worst[0]]).any() or any(
        word in text for text in said for word in (name, "friction errs", "error is not known")
    )
    category = "kept" if worst[1] <= 1.0 else "stated" if named else "silent"
    return *worst, category


def limited(seconds, function, *arguments):
    """What a function returns, and its time of the processor [s]; `TooDearError` beyond a time."""
    begin = time.process_time()
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds)
    try:
        return function(*arguments), time.process_time() - begin
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)


def answered(one):
    """The default result of a scene, and its answer."""
    result = rollslip.run(one, STUDY)
    return result, rollslip.answer(result)


def run_finer(study, assembly):
    """The result of a study at a resolution, with play in the pockets."""
    return study.completed(assembly, study.run(assembly))


def row(k):
    """The row of a scene."""
    found = dict.fromkeys(HEADER, "") | {"scene": k}
    begin = time.process_time()
    try:
        one = scenes.scene(k)
        found["what"] = scenes.described(one)
        (result, answer), seconds = limited(LONGEST, answered, one)
        found["verdict"] = f"{answer.verdict} {answer.rule}"
    except accuracy.TooDearError:
        return found | {"category": "too long", "seconds": f"{LONGEST:.1f}"}
    except RollslipError as error:
        seconds = time.process_time() - begin
        return found | {"category": "refused", "words": str(error), "seconds": f"{seconds:.1f}"}
    except Exception as error:  # a fault of rollslip
        return found | {"category": "crash", "words": f"{type(error).__name__}: {error}"}
    found["seconds"] = f"{seconds:.1f}"
    own = Resolution(**json.loads(result.attrs["resolution"]))
    found |= {"slices": own.slices, "positions": own.n_positions}
    bearing = assemble(one)
    study = plan(one, STUDY).studies[STUDY]
    spent = 0.0
    for times in (accuracy.TIMES, accuracy.TWICE):
        finer = accuracy.finer(bearing, own, result, times)
        try:
            exact, seconds = limited(SECONDS, run_finer, study, assemble(one, finer))
        except accuracy.TooDearError:
            return found if spent else found | {"category": NOT_KNOWN}
        except RollslipError as error:
            return found if spent else found | {"category": "no reference", "words": str(error)}
        spent += seconds
        number, off, allowed, category = compared(result, exact, one.accuracy.tolerance)
        found |= {"number": number, "off over allowed": f"{off:.2f}", "allowed": f"{allowed:.1e}"}
        found |= {"category": category, "seconds of the reference": f"{spent:.1f}"}
        if category != "silent" and not accuracy.CLOSE[0] <= off <= accuracy.CLOSE[1]:
            break
    return found


def summary(rows):
    """Scenes by what they have in particular: how many of each category, and how many are slow."""
    categories = list(dict.fromkeys(one["category"] for one in rows))
    yield ["scenes with", "scenes", *categories, f"slower than {SLOW:g} s"]
    for name, pattern in KINDS.items():
        of = [one for one in rows if re.search(pattern, one["what"])]
        ends = Counter(one["category"] for one in of)
        slow = sum(float(one["seconds"] or 0.0) > SLOW for one in of)
        yield [name, len(of), *(ends[category] for category in categories), slow]


def main(count=500, seconds=1e9, first=0):
    """Judge the scenes that are not known yet, as many as fit into a time of the processor [s], and write the table."""
    path = Path(__file__).with_suffix(".csv")
    rows = list(csv.DictReader(path.open(encoding="utf-8"))) if path.exists() else []
    known = {int(one["scene"]) for one in rows}
    begin = time.process_time()
    signal.signal(signal.SIGVTALRM, accuracy.stop)
    for k in range(int(first), int(first) + int(count)):
        if k in known:
            continue
        if time.process_time() - begin > float(seconds):
            break
        found = {key: str(cell).replace("\n", " ")[:400] for key, cell in row(k).items()}
        rows.append(found)
        rows.sort(key=lambda one: int(one["scene"]))
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, HEADER, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    with SUMMARY.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows(summary(rows))
    print(len(rows), dict(Counter(one["category"] for one in rows)))


if __name__ == "__main__":
    main(*sys.argv[1:])
