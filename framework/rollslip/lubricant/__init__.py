"""Oils: viscosity and pressure-viscosity coefficient over temperature, by formula, fit or table."""

from rollslip.lubricant.fits import fit_vogel, fit_walther
from rollslip.lubricant.oil import GRADES, Lubricant, OilState, Scatter
from rollslip.lubricant.table import OilPoint, OilTable, OverTemperature, lubricant_from_table
from rollslip.lubricant.temperature import (
    Andrade,
    Constant,
    Exponential,
    Hyperbola,
    PowerOfViscosity,
    Product,
    SmoothTable,
    Table,
    TemperatureLaw,
    Vogel,
    Walther,
    WuKlausDuda,
)

__all__ = [
    "GRADES",
    "Andrade",
    "Constant",
    "Exponential",
    "Hyperbola",
    "Lubricant",
    "OilPoint",
    "OilState",
    "OilTable",
    "OverTemperature",
    "PowerOfViscosity",
    "Product",
    "Scatter",
    "SmoothTable",
    "Table",
    "TemperatureLaw",
    "Vogel",
    "Walther",
    "WuKlausDuda",
    "fit_vogel",
    "fit_walther",
    "lubricant_from_table",
]
