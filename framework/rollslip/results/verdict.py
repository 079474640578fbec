"""The verdict of an answer: its rules, and which of them decides.

1. A rule compares facts, which are intervals, with limits. It holds, does not hold, or the facts leave it open.
2. The worst verdict of the rules that hold or are left open is that of the answer; of several rules the first decides
   (`decide`).
3. A rule for SKIDS that is left open leads to UNKNOWN; so does a rule for SLIPS or SKIDS whose facts are not known.
"""

import enum
import math
from collections.abc import Mapping
from typing import Final

import attrs

__all__ = [
    "RULES",
    "SKIDDING_SLIP",
    "Fact",
    "Interval",
    "Rule",
    "Verdict",
    "decide",
    "evaluate_rule",
    "is_as_bad",
]


class Verdict(enum.StrEnum):
    """The verdict of an answer on the slip of the cage."""

    OK = "OK"  #: It slips less than is acceptable, and where data scatter less than twice that.
    SLIPS = "SLIPS"  #: It slips more than is acceptable, or may, and does not skid.
    SKIDS = "SKIDS"  #: It slips by more than `SKIDDING_SLIP`, or the drags are larger than the limit drag torque.
    UNKNOWN = "UNKNOWN"  #: It may skid, or nothing is known, or the models are outside their range.


class Fact(enum.StrEnum):
    """A quantity that rules compare, by its name in messages."""

    CAGE_SLIP = "cage slip"
    ACCEPTABLE_SLIP = "acceptable slip"
    BAND_HIGH = "high end of the band"
    CHOICE = "largest slip by a choice that nobody made"
    RESERVE = "reserve to skidding"
    VISCOSITY_RATIO = "viscosity ratio kappa"
    FILM_PARAMETER = "film parameter Lambda"
    AXIAL_RATIO = "axial over radial load"


#: Verdicts from the best to the worst. A bearing that slips more, or of which less is known, never gets a better one.
_RANKS: Final = (Verdict.OK, Verdict.SLIPS, Verdict.UNKNOWN, Verdict.SKIDS)
#: Cage slip from which a cage skids, in verdicts, reserves and motions alike. Chosen: drags near the limit drag torque
#: lead to such slips.
SKIDDING_SLIP: Final = 0.2


@attrs.frozen(kw_only=True)
class Rule:
    """A rule of the verdict, which holds if all its conditions hold."""

    code: str
    verdict: Verdict
    #: Conditions: a fact, a sign and a limit, which is a number, or a factor on another fact. The sign "none" means
    #: that the fact is not known.
    conditions: tuple[tuple[Fact, str, float | tuple[float, Fact]], ...]
    #: Text beside the row; {acceptable} and {twice} are once and twice the acceptable slip.
    remark: str = ""
    #: The same where the accuracy of the facts leaves open whether the rule holds; empty if it is the remark.
    open_remark: str = ""
    row: str = "cage_slip"  #: Key of the row beside which the remark is shown.
    source: str = "a choice"  #: Reason of the limit.
    remedy: str = ""  #: What decides an open verdict.

    @property
    def condition(self) -> str:
        """All conditions in words; "else" where there is none."""
        texts = []
        for fact, sign, limit in self.conditions:
            if sign == "none":
                texts.append(f"{fact} is not known")
            elif not isinstance(limit, tuple):
                texts.append(f"{fact} {sign} {limit:g}")
            else:
                factor, other = limit
                number = other if factor == 1.0 else f"{factor:g} x {other}"
                texts.append(f"{fact} {sign} {number}")
        return " and ".join(texts) or "else"


#: The rules of the verdict. Of those that hold the one for the worst verdict decides, of several the first.
RULES: Final = (
    Rule(code="V3", verdict=Verdict.SKIDS, conditions=((Fact.CAGE_SLIP, ">", SKIDDING_SLIP),), remark="above 20 %"),
    Rule(code="V1", verdict=Verdict.SKIDS, conditions=((Fact.RESERVE, "<", 1.0),), row="drag_reserve",
         remark="the drags are larger than what the rollers carry", source="balance of torques"),
    Rule(code="V2", verdict=Verdict.UNKNOWN, conditions=((Fact.CAGE_SLIP, "none", 0.0),), source="nothing can be said"),
    Rule(code="V4", verdict=Verdict.UNKNOWN, conditions=((Fact.RESERVE, "<", 1.5),), row="drag_reserve",
         remark="below 1.5, may skid", source="a choice: drags are known to a factor"),
    Rule(code="V5", verdict=Verdict.UNKNOWN, conditions=((Fact.BAND_HIGH, ">", SKIDDING_SLIP),),
         remark="may skid", remedy="rollslip uncertainty SCENE says which data decide; state these"),
    Rule(code="V10", verdict=Verdict.UNKNOWN, conditions=((Fact.CHOICE, ">", SKIDDING_SLIP),),
         remark="may skid, see assumed",
         remedy="state in the scene what the answer has under 'assumed'; rollslip run SCENE --all lists all of it"),
    Rule(code="V11", verdict=Verdict.UNKNOWN, conditions=((Fact.VISCOSITY_RATIO, ">", 100.0),), row="film_parameter",
         remark="kappa above 100 is outside the range of the models"),
    Rule(code="V12", verdict=Verdict.UNKNOWN, conditions=((Fact.FILM_PARAMETER, "<", 0.1),), row="film_parameter",
         remark="Lambda below 0.1 is outside the range of the models"),
    Rule(code="V13", verdict=Verdict.UNKNOWN, conditions=((Fact.AXIAL_RATIO, ">", 0.5),), row="axial_load",
         remark="above half of the radial load, friction of the ribs decides",
         source="SKF, general catalogue 17000: at most half of the radial load",
         remedy="more radial load, or models.rib by a measurement"),
    Rule(code="V6", verdict=Verdict.SLIPS, conditions=((Fact.CAGE_SLIP, ">", (1.0, Fact.ACCEPTABLE_SLIP)),),
         remark="above the acceptable {acceptable}", open_remark="may be above the acceptable {acceptable}",
         source="what a scene calls acceptable, by default a choice"),
    Rule(code="V7", verdict=Verdict.SLIPS, conditions=((Fact.BAND_HIGH, ">", (2.0, Fact.ACCEPTABLE_SLIP)),),
         remark="may be above {twice}"),
    Rule(code="V8", verdict=Verdict.SLIPS, conditions=((Fact.RESERVE, "<", 2.0),), row="drag_reserve",
         remark="below 2, may slip", source="a choice: drags are known to a factor"),
    Rule(code="V9", verdict=Verdict.OK, conditions=(), source="else"),
)  # fmt: skip
#: Lower and upper bound of a fact.
Interval = tuple[float, float]
#: A fact that is not known.
_NOT_KNOWN: Final[Interval] = (math.nan, math.nan)


def evaluate_rule(rule: Rule, facts: Mapping[Fact, Interval]) -> bool | None:
    """Return whether all conditions of a rule hold; None where the facts do not decide it."""
    states = [
        _evaluate_condition(facts.get(fact, _NOT_KNOWN), sign, limit, facts)
        for fact, sign, limit in rule.conditions
    ]
    if False in states:
        return False
    return None if None in states else True


def _evaluate_condition(
    fact: Interval, sign: str, limit: float | tuple[float, Fact], facts: Mapping[Fact, Interval]
) -> bool | None:
    """Return whether a fact is below ("<") or above (">") a limit; None where their intervals overlap."""
    if sign == "none":
        return math.isnan(fact[0])
    if isinstance(limit, tuple):
        factor, other = limit
        low, high = facts.get(other, _NOT_KNOWN)
        bounds = factor * low, factor * high
    else:
        bounds = limit, limit
    smaller, larger = (fact, bounds) if sign == "<" else (bounds, fact)
    if smaller[1] < larger[0]:
        return True
    return False if smaller[0] >= larger[1] else None


def decide(facts: Mapping[Fact, Interval]) -> tuple[Rule, Verdict, str]:
    """Return the rule that decides, its verdict and the remark.

    A rule that known facts leave open counts as one that holds, because its accuracy does not exclude it; a rule for
    SKIDS leads to UNKNOWN then. A rule whose facts are not known leads to UNKNOWN where its verdict is worse, unless
    that is UNKNOWN itself, as of ranges of the models.
    """
    candidates = list[tuple[Rule, Verdict, str]]()
    unknown = list[tuple[Rule, Verdict, str]]()
    for rule in RULES:
        state = evaluate_rule(rule, facts)
        missing = [
            fact for fact, *_ in rule.conditions if math.isnan(facts.get(fact, _NOT_KNOWN)[0])
        ]
        if state is None and missing:
            # a rule for SLIPS decides here where the slip is known, and is acceptable
            what = "may slip more" if rule.verdict is Verdict.SLIPS else rule.verdict.lower()
            remark = f"whether it {what} is not known: no {' and '.join(missing)}"
            unknown.append((rule, Verdict.UNKNOWN, remark))
        elif state is None and rule.verdict is Verdict.SKIDS:
            remark = f"whether {rule.condition} is not known"
            candidates.append((rule, Verdict.UNKNOWN, remark))
        elif state is not False:
            remark = rule.remark if state else rule.open_remark or rule.remark
            candidates.append((rule, rule.verdict, remark))
    rank = _RANKS.index
    worst = max(candidates, key=lambda candidate: rank(candidate[1]))
    for candidate in unknown:
        is_worse = rank(worst[1]) < rank(candidate[0].verdict)
        if is_worse and Verdict.UNKNOWN not in (worst[1], candidate[0].verdict):
            return candidate
    return worst


def is_as_bad(verdict: str, other: str) -> bool:
    """Whether a verdict is at least as bad as another one; no verdict is not.

    Parameters
    ----------
    verdict, other : str
        Verdicts in any letters.
    """
    ranks = {name.casefold(): rank for rank, name in enumerate(_RANKS)}
    return ranks.get(verdict.casefold(), -1) >= ranks[other.casefold()]
