"""Symbols that many laws share, each explained once; `explained` inserts them where a docstring lists a name alone."""

import re
import textwrap
from typing import Final, TypeVar

__all__ = ["explained"]

_T = TypeVar("_T", bound=type)

#: First symbol of an entry -> the entry.
_SHARED: Final = {
    re.split("[:,]", entry, maxsplit=1)[0]: entry
    for entry in (
        "alpha: pressure-viscosity coefficient [1/Pa]",
        "b: half width of the contact [m]",
        "beta: its fall with temperature -dln(eta)/dT [1/K]",
        "E': equivalent modulus 2/sum((1 - nu^2)/E) [Pa]",
        "eta0: viscosity at ambient pressure [Pa s]",
        "eta: viscosity at the mean pressure and inlet temperature [Pa s]",
        "f: factor for calibration and scatter (``factor``), 1 by default [1]",
        "F_r: radial load [N]",
        "flash: factor of the mean flash temperature (``flash``) [1]",
        "G: material parameter alpha E' [1]",
        "h: film thickness [m]",
        "K, rho, c: conductivity, density and heat capacity of the steel; sqrt(K rho c) is its effusivity "
        "[J/(m2 K s^0.5)]",
        "K_f: conductivity of the oil [W/(m K)]",
        "l: length of the contact [m]",
        "Lambda: film thickness over the composite rms roughness 1.25 sqrt(Ra1^2 + Ra2^2) [1]",
        "mu: friction coefficient, with the sign of V [1]",
        "mu_bd: that of boundary friction (``boundary``) [1]",
        "mu_hd: that of the full film (``hydrodynamic``) [1]",
        "p: mean pressure of the contact [Pa]",
        "Phi: heating beta zeta tau0^2 h/eta [1]",
        "R: equivalent radius [m]",
        "sigma: strain rate eta V/(tau0 h) [1]",
        "T: torque on the cage [N m]",
        "tau0: Eyring stress of the oil, with its rise to p (``eyring_stress_slope``) [Pa]",
        "u: mean of the two surface speeds [m/s]",
        "U: speed parameter eta0 u/(E' R) [1]",
        "V: sliding speed [m/s]",
        "W: load parameter w/(E' R) [1]",
        "w: load per length [N/m]",
        "w_c: speed of the cage [rad/s]",
        "zeta: temperature of the film over tau V, flash sqrt(b/(pi u))/sqrt(K rho c) + h/(12 K_f) [K m2/W]",
    )
}


def explained(cls: _T) -> _T:
    """Return a class whose docstring has symbols with meaning and unit in place of lists of names such as "- R, U"."""
    if cls.__doc__:
        cls.__doc__ = re.sub(
            r"^( *)- ([^:\n]+(?:\n\1  [^:\n]+)*)$", _items, cls.__doc__, flags=re.MULTILINE
        )
    return cls


def _items(match: re.Match[str]) -> str:
    """Return a list of symbols with meaning and unit in place of their names."""
    items = (
        textwrap.wrap(f"- {_SHARED[name]}", 116, subsequent_indent="  ")
        for name in " ".join(match[2].split()).split(", ")
    )
    return "\n".join(f"{match[1]}{line}" for item in items for line in item)
