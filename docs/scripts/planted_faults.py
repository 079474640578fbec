"""Write docs/tables/planted_faults.csv: faults that authors make in packages, and the rule that finds each.

A fault is one replacement in the file that ``rollslip plugins new`` writes for a kind, or in the built-in law of Barus:
a unit, a factor, a sign, a digit. The whole kit runs on the law without its equation and its reference value, since an
author may state neither. Then the rules that use these run on the law with them.
"""

import importlib
import inspect
import os
import re
import sys
import tempfile
from pathlib import Path

from output import write_table

from rollslip.catalogue.scaffold import package
from rollslip.errors import RollslipError
from rollslip.testing import checks_of, conformance
from rollslip.testing.findings import run_check
from rollslip_plugins import pressure_viscosity

#: Kind -> faults: what is wrong, the text in the file, and what stands in its place.
LAWS = {
    "traction": (
        ("viscosity in mPa s", "slices.film_viscosity *", "1e3 * slices.film_viscosity *"),
        ("film in um", "slices.film_thickness *", "1e6 * slices.film_thickness *"),
        ("maximum for mean pressure", "slices.pressure)", "slices.pressure * 1.2732)"),
        ("limit in percent", "-self.limit, self.limit", "-100 * self.limit, 100 * self.limit"),
        ("limit forgotten for negative slip", "-self.limit, self.limit", "-1.0, self.limit"),
        ("friction of the other sign", "np.clip(newtonian", "-np.clip(newtonian"),
        ("friction 1e-6 of what it should be", "np.clip(newtonian", "1e-6 * np.clip(newtonian"),
        ("friction without a sign", "np.clip(newtonian", "np.clip(abs(newtonian)"),
        ("half of the sliding speed", "slices.sliding_speed /", "0.5 * slices.sliding_speed /"),
        ("a limit of 0.8", "default=0.08", "default=0.8"),
        ("single precision", "newtonian,", "newtonian.astype('f4'),"),
        ("two maxima", "np.clip(newtonian", "np.cos(5e3 * newtonian) ** 2 * np.clip(newtonian"),
        (
            "a jump at the limit",
            "np.clip(newtonian",
            "(1 - 0.1 * (newtonian > 0.02)) * np.clip(newtonian",
        ),
    ),
    "film": (
        ("viscosity in mPa s", "c.viscosity *", "1e3 * c.viscosity *"),
        ("radius squared", "c.radius / slices.load", "c.radius**2 / slices.load"),
        ("sum for mean of the speeds", "* slices.rolling_speed", "* 2 * slices.rolling_speed"),
        ("film in um", "self.factor *", "1e6 * self.factor *"),
        ("two digits of the factor exchanged", "default=4.895", "default=4.985"),
        (
            "load and speed exchanged",
            "slices.rolling_speed * c.radius / slices.load",
            "slices.load * c.radius / slices.rolling_speed",
        ),
    ),
    "contact": (
        (
            "maximum for mean pressure",
            "(2 * slices.half_width)",
            "(2 * slices.half_width) * 1.2732",
        ),
        ("full width for half", "np.cbrt(1.5", "2 * np.cbrt(1.5"),
        (
            "stiffness per diameter",
            "2 * self.foundation * half_width",
            "self.foundation * half_width",
        ),
        ("approach in um", "slices.approach, 0.0", "1e6 * slices.approach, 0.0"),
        ("square for cube of the width", "half_width**3", "half_width**2"),
    ),
    "drag": (
        ("speed in 1/min", "(outer_speed - cage_speed)", "(outer_speed - cage_speed) * 9.549"),
        ("lengths in mm", "self.radius**3", "(1e3 * self.radius)**3"),
        ("driving torque", "(outer_speed - cage_speed)", "(cage_speed - outer_speed)"),
    ),
    "loss": (
        ("torque in N mm", "0.5 * math.pi", "500 * math.pi"),
        ("speed in 1/min", "duty.speed", "duty.speed * 9.549"),
    ),
    "pressure-viscosity": (
        (
            "gamma with the other sign",
            "c.thermoviscosity + self.factor",
            "c.thermoviscosity - self.factor",
        ),
        (
            "a slope of 2 alpha at no pressure",
            "np.exp(self.factor * c.p",
            "np.exp(2 * self.factor * c.p",
        ),
    ),
}
#: Changes of the sound oil of the template.
OILS = (
    ("viscosity in mPa s", "[32e-6, 5.4e-6]", "[32e-3, 5.4e-3]"),
    ("kinematic viscosity in Pa s", "density=_DENSITY", "density=1.0"),
    ("alpha in 1/GPa", "Constant(2.0e-8)", "Constant(20.0)"),
    ("alpha 10 times too large", "Constant(2.0e-8)", "Constant(2.0e-7)"),
    ("conductivity / 100", "Constant(0.13)", "Constant(0.0013)"),
    ("Eyring stress in MPa", "eyring_stress=5e6", "eyring_stress=5.0"),
    ("density in g/cm3", "conductivity=", "density=Constant(0.87), conductivity="),
    (
        "constants of a law that there is not",
        "conductivity=",
        "models={'eyrign': {'flash': 1.0}}, conductivity=",
    ),
    (
        "a constant that its law does not have",
        "conductivity=",
        "models={'eyring': {'flsh': 1.0}}, conductivity=",
    ),
    ("a negative constant", "conductivity=", "models={'eyring': {'flash': -1.0}}, conductivity="),
    ("points of viscosity exchanged", "[32e-6, 5.4e-6]", "[5.4e-6, 32e-6]"),
)

#: Rules that use what an author states of a law.
STATED = ("check_computes_its_equation", "check_reproduces_its_reference_values")
#: Texts that make Barus's law one in Python.
PYTHON = (
    ("return compiled.barus(self.factor)", "return None"),
    ("return compiled.barus(self.factor, True)", "return None"),
)


def source(kind):
    """Return the text of the law of a kind."""
    if kind == "pressure-viscosity":
        text = inspect.getsource(pressure_viscosity)
        for old, new in PYTHON:
            text = text.replace(old, new)
        return text.replace('"barus"', '"planted"')
    files = package("rollslip-planted", kind, False)
    return files[f"src/rollslip_planted/{kind}.py"]


def without_statements(text):
    """Return a law without equation and reference values."""
    text = re.sub(
        r'equation: ClassVar\[str\] = ".*"', 'equation: ClassVar[str] = "as in the source"', text
    )
    return text.replace("reference_values: ClassVar", "others: ClassVar")


def law(folder, text):
    """Return the model or oil of a module with this text."""
    name = f"planted_{len([*folder.iterdir()])}"
    (folder / f"{name}.py").write_text(text, encoding="utf-8")
    importlib.invalidate_caches()
    module = importlib.import_module(name)
    if hasattr(module, "OIL"):
        return module.OIL
    return next(cls for cls in vars(module).values() if getattr(cls, "name", "") == "planted")()


def rules(findings):
    """Return the names of rules that are broken, or warn."""
    return {f.check for f in findings if f.status in ("failed", "warning")}


def finders(folder, kind, old, new):
    """Return the rules that find a fault by the law alone, and those that do so by what its author states."""
    sound = source(kind)
    assert sound.count(old) >= 1, (kind, old)
    faulty = sound.replace(old, new)
    try:
        model = law(folder, faulty)
    except (RollslipError, ValueError) as error:
        return {f"refused when it is made: {error}"}, set()
    alone = rules(conformance(law(folder, without_statements(faulty))))
    alone -= rules(conformance(law(folder, without_statements(sound))))
    checks = [check for check in checks_of(model) if check.__name__ in STATED]
    parts = [model, *([model.deflection()] if kind == "contact" else [])]
    return alone, rules(
        run_check(part, check)[0] for part in parts for check in checks if check in checks_of(part)
    )


def rows(folder):
    """Yield kind, fault, a rule that finds it by the law alone, and one that does so by what its author states."""
    for kind, faults in (*LAWS.items(), ("lubricant", OILS)):
        for what, old, new in faults:
            alone, stated = finders(folder, kind, old, new)
            print(kind, what, sorted(alone), sorted(stated), flush=True)
            yield kind, what, min(alone, default=""), min(stated, default="")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        sys.path.insert(0, place)
        os.environ["PYTHONPATH"] = place
        write_table(
            "planted_faults",
            ("kind", "fault", "found by", "found by what is stated"),
            rows(Path(place)),
        )
