"""What keeps the rollers apart: a cage, or nothing but the rollers themselves in a full complement."""

from typing import ClassVar, Final

import attrs

from rollslip.bearing.cage import Separator
from rollslip.fields import Scatter, non_negative, parameter
from rollslip.hookspecs import hookimpl
from rollslip.references import Citation, Reference
from rollslip_plugins.bibliography import HARRIS_2007

_DERIVED: Final = Reference(
    kind="remark",
    title="Derived from the momentum of each roller: docs/theory/motion.rst. Friction is that of the boundary law of "
    "raceways where nothing but sliding is left.",
)


@attrs.frozen(kw_only=True)
class Caged(Separator):
    """A cage whose pockets keep rollers at equal distances; table ``[cage]`` says what it is like.

    Symbols:

    - w_k: orbital speed of roller k [rad/s]
    - w_c: speed of the cage [rad/s]

    Range: steady slips and level ``cage-set`` of a motion; levels ``pocket`` and ``planar`` have play.
    """

    name: ClassVar[str] = "cage"
    equation: ClassVar[str] = "w_k = w_c"
    references: ClassVar[tuple[Citation, ...]] = (HARRIS_2007,)


@attrs.frozen(kw_only=True)
class FullComplement(Separator):
    """No cage: rollers push their neighbours and rub against them, M = mu r (N_(k-1/2) + N_(k+1/2)).

    Neighbours spin the same way, so that they slide at the sum of their surface speeds, and the entrainment speed of
    their contact, half of the difference, is next to nothing. So no film is drawn in, and friction is that of the
    boundary: the law of the boundary friction of raceways tends to 0.1 where sliding is far more than rolling (B).

    Symbols:

    - M: moment against the spin of a roller, relative to the orbit [N m]
    - mu: coefficient of friction of neighbours (``coefficient``) [1]
    - r: radius of a roller [m]
    - N: normal force between neighbours; their differences carry the rollers round, and the least is zero [N]

    Range: a train with play, less than one roller, whose crossing of the gap is left out; that pushes press rollers on
    the outer ring is left out too. Hot films of opposite speeds carry, so mu may be less by far: 0.02 to 0.15 (C).

    Examples
    --------
    >>> FullComplement().coefficient
    0.1
    """

    name: ClassVar[str] = "none"
    equation: ClassVar[str] = "M = mu r (N_(k-1/2) + N_(k+1/2))"
    references: ClassVar[tuple[Citation, ...]] = (_DERIVED,)

    coefficient: float = parameter(
        default=0.1,
        unit="1",
        validator=non_negative,
        doc="friction coefficient mu of rollers against their neighbours",
        usual=(0, 0.3),
        possible=(0, 1),
        scatter=Scatter(
            distribution="lognormal",
            parameters={"deviation_of_ln": 0.5},
            grade="(D)",
            source="0.02 to 0.15: boundary friction (B), less where a hot film of opposite surface speeds carries (C)",
        ),
    )


@hookimpl
def separators() -> list[type[Separator]]:
    """Offer what is there of separators."""
    return [Caged, FullComplement]
