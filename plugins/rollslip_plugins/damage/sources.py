"""The publications that measures of damage rest on; `rollslip_plugins.bibliography` has those of all other models."""

from typing import Final

from rollslip.references import Reference

__all__ = ["AGMA_925", "BLOK_1937", "HAMROCK_ANDERSON_1983", "ISO_13989", "JAEGER_1942", "MATVEEVSKY_1965"]

BLOK_1937: Final = Reference(
    kind="proceedings",
    authors=("Blok, H.",),
    title="Theoretical study of temperature rise at surfaces of actual contact under oiliness lubricating conditions",
    journal="Proc. General Discussion on Lubrication and Lubricants, Inst. Mech. Eng., London",
    volume="2",
    pages="222-235",
    publisher="Institution of Mechanical Engineers",
    year=1937,
    note="recalled, not read; its factor 1.11 is confirmed by integration",
)
JAEGER_1942: Final = Reference(
    authors=("Jaeger, J. C.",),
    title="Moving sources of heat and the temperature at sliding contacts",
    journal="J. Proc. R. Soc. New South Wales",
    volume="76",
    pages="203-224",
    year=1942,
    note="recalled, not read; its integral is derived in Carslaw and Jaeger (1959), section 10.7",
)
MATVEEVSKY_1965: Final = Reference(
    authors=("Matveevsky, R. M.",),
    title="The critical temperature of oil with point and line contact machines",
    journal="J. Basic Eng.",
    volume="87",
    pages="754-760",
    year=1965,
    note="recalled, not read: friction power intensity",
)
HAMROCK_ANDERSON_1983: Final = Reference(
    kind="report",
    authors=("Hamrock, B. J.", "Anderson, W. J."),
    title="Rolling-Element Bearings",
    publisher="NASA",
    number="RP-1105",
    year=1983,
    note="recalled, not read",
)
ISO_13989: Final = Reference(
    kind="standard",
    title="Calculation of scuffing load capacity of cylindrical, bevel and hypoid gears, part 1: flash temperature "
    "method",
    number="ISO/TR 13989-1:2000 (now ISO/TS 6336-20)",
    note="not read; its equations 27 and 99 as an open program states them, which meets printed reports within 0.2 %",
)
AGMA_925: Final = Reference(
    kind="standard",
    title="Effect of lubrication on gear surface distress",
    number="AGMA 925-A03",
    note="recalled, not read",
)
