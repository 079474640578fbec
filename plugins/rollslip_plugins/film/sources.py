"""Publications that films rest on and that came after `rollslip_plugins.bibliography` was full."""

from typing import Final

from rollslip.references import Reference

__all__ = ["CHEVALIER_1998"]

CHEVALIER_1998: Final = Reference(
    authors=("Chevalier, F.", "Lubrecht, A. A.", "Cann, P. M. E.", "Colin, F.", "Dalmaz, G."),
    title="Film thickness in starved EHL point contacts",
    journal="J. Tribol.",
    volume="120",
    pages="126-133",
    year=1998,
)
