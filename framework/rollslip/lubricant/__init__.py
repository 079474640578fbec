"""What an oil is: viscosity and pressure-viscosity over temperature, by formula, fit or table."""

from rollslip.lubricant.fits import fit_vogel, fit_walther
from rollslip.lubricant.oil import Lubricant, OilState, Scatter
from rollslip.lubricant.table import OilPoint, OilTable, lubricant_from_table
from rollslip.lubricant.temperature import (
    Andrade,
    Constant,
    Exponential,
    Hyperbola,
    PowerOfViscosity,
    Table,
    TemperatureLaw,
    Vogel,
    Walther,
)

__all__ = [
    "Andrade",
    "Constant",
    "Exponential",
    "Hyperbola",
    "Lubricant",
    "OilPoint",
    "OilState",
    "OilTable",
    "PowerOfViscosity",
    "Scatter",
    "Table",
    "TemperatureLaw",
    "Vogel",
    "Walther",
    "fit_vogel",
    "fit_walther",
    "lubricant_from_table",
]
