"""A module of another package for each kind without a template: tests install it and call it after the kind."""

#: Kind -> source of a module that offers one thing called NAME.
FOREIGN = {
    "account": """
from rollslip.hookspecs import hookimpl
from rollslip.results.account import Account

@hookimpl
def accounts():
    return [Account("NAME")]
""",
    "bearing": """
from rollslip.datasets import BearingData
from rollslip.hookspecs import hookimpl
from rollslip.scene import Bearing

@hookimpl
def bearings():
    bearing = Bearing(
        rollers=16, roller_diameter=0.011, roller_length=0.012, inner_raceway_diameter=0.0595,
        outer_raceway_diameter=0.0815,
    )
    return [BearingData(
        name="NAME", description="A bearing of 50 x 90 x 20 mm", source="Measured on one piece.", validity="Unmounted.",
        references=("The drawing of the author, 2026.",), bearing=bearing,
    )]
""",
    "damage": """
import attrs
import numpy as np
from rollslip.hookspecs import hookimpl
from rollslip.studies.surface_damage.model import DamageModel

@attrs.frozen(kw_only=True)
class FrictionStress(DamageModel):
    '''Force of friction on the area of a contact.'''

    name = "NAME"
    equation = "tau = |mu| p"
    references = ("Johnson K.L. Contact Mechanics. Cambridge University Press, 1985.",)
    measure = "friction stress"
    unit = "Pa"
    scope = "it knows nothing of how fast or how far surfaces slide"
    limit = (100e6, "an example")

    def evaluate(self, contacts):
        return np.abs(contacts.slices.friction) * contacts.slices.pressure

@hookimpl
def damage_models():
    return [FrictionStress]
""",
    "life": """
import attrs
from rollslip.hookspecs import hookimpl
from rollslip.studies.rating_life.model import LifeModel, RatedLife

@attrs.frozen(kw_only=True)
class Cubic(LifeModel):
    '''The life of ball bearings.'''

    name = "NAME"
    equation = "L = (C/P)^3"
    references = ("Palmgren A. Ball and Roller Bearing Engineering. Burbank, 1959.",)
    basis = "the exponent of ball bearings"

    def rate(self, duty):
        P = duty.radial_load
        return RatedLife(revolutions=1e6 * (duty.dynamic_rating / P) ** 3, equivalent_load=P)

@hookimpl
def life_models():
    return [Cubic]
""",
    "engine": """
import attrs
from rollslip.hookspecs import hookimpl
from rollslip_plugins.engines import Threads

@attrs.frozen(kw_only=True)
class OwnThreads(Threads):
    '''Threads of this process.'''

    name = "NAME"

@hookimpl
def engines():
    return [OwnThreads]
""",
    "measurement": """
from rollslip.hookspecs import hookimpl
from rollslip_campaigns.measurement import load_measurement

@hookimpl
def measurements():
    return [load_measurement("DATA")]
""",
    "pressure": """
import attrs
from rollslip.hookspecs import hookimpl
from rollslip_plugins.film_pressure import LightContact

@attrs.frozen
class OwnPressure(LightContact):
    '''Mean pressure in a film under light load.'''

    name = "NAME"

@hookimpl
def pressure_models():
    return [OwnPressure]
""",
    "pressure-viscosity": """
import attrs
from rollslip.hookspecs import hookimpl
from rollslip_plugins.pressure_viscosity import Barus

@attrs.frozen
class OwnBarus(Barus):
    '''Viscosity that rises exponentially with the pressure.'''

    name = "NAME"

@hookimpl
def pressure_viscosity_laws():
    return [OwnBarus]
""",
    "ring": """
import attrs
import numpy as np
from rollslip.fields import parameter, positive
from rollslip.hookspecs import hookimpl
from rollslip.rings import RingModel, RingShapes

@attrs.frozen(kw_only=True)
class WideningRing(RingModel):
    '''A ring that only widens, by its tension.'''

    name = "NAME"
    equation = "w = Q/(2 pi E A/R)"
    references = ("Timoshenko S. Strength of Materials, part II. Van Nostrand, 1956.",)
    tension: float = parameter(default=4e7, unit="N", validator=positive, doc="stiffness of the section, E A")

    def shapes(self, bearing, ring, turns):
        diameter = bearing.outer_raceway_diameter if ring == "outer" else bearing.inner_raceway_diameter
        return RingShapes(np.ones((1, 1), complex), np.array([4.0 * np.pi * self.tension / diameter]))

@hookimpl
def ring_models():
    return [WideningRing]
""",
    "thermal": """
import attrs
import numpy as np
from rollslip.hookspecs import hookimpl
from rollslip.studies.thermal_balance.model import ROLES, ThermalModel

@attrs.frozen(kw_only=True)
class OneBody(ThermalModel):
    '''One temperature for all parts, and a conductance of 10 W/K to surroundings of 20 degC.'''

    name = "NAME"
    equation = "C dT/dt = sum(H) - K (T - T_a)"
    references = ("Palmgren A. Ball and Roller Bearing Engineering. SKF Industries, 1959.",)
    nodes = ("bearing",)

    def start(self, scene):
        return np.array([scene.operation.temperature])

    def capacities(self):
        return np.array([2000.0])

    def inflows(self, temperatures, losses):
        return np.array([sum(losses.values()) - sum(self.carried_away(temperatures).values())])

    def carried_away(self, temperatures):
        return {"surroundings": 10.0 * (float(temperatures[0]) - 293.15)}

    def changes(self, temperatures, scene):
        return dict.fromkeys(ROLES, float(temperatures[0]))

@hookimpl
def thermal_models():
    return [OneBody]
""",
    "loss": """
import attrs
from rollslip.hookspecs import hookimpl
from rollslip.studies.steady_slip.loss import LossModel

@attrs.frozen(kw_only=True)
class GreaseDrag(LossModel):
    '''A constant torque of 20 N mm.'''

    name = "NAME"
    equation = "P = M w"
    references = ("Palmgren A. Ball and Roller Bearing Engineering. SKF Industries, 1959.",)

    def power(self, duty):
        return 0.02 * duty.speed

@hookimpl
def loss_models():
    return [GreaseDrag]
""",
    "rib": """
import attrs
from rollslip.hookspecs import hookimpl
from rollslip.models import RibModel

@attrs.frozen(kw_only=True)
class ViscousRib(RibModel):
    '''Friction in proportion to sliding speed and the root of the load.'''

    name = "NAME"
    equation = "F = 1e-3 V sqrt(Q)"
    references = ("Palmgren A. Ball and Roller Bearing Engineering. SKF Industries, 1959.",)

    def friction(self, contact):
        return 1e-3 * contact.sliding_speed * contact.load ** 0.5

@hookimpl
def rib_models():
    return [ViscousRib]
""",
    "torque": """
import attrs
from rollslip.hookspecs import hookimpl
from rollslip.studies.steady_slip.torque import TorqueFormula

@attrs.frozen(kw_only=True)
class PitchFriction(TorqueFormula):
    '''A coefficient of friction of 0.001 at the pitch circle.'''

    name = "NAME"
    equation = "M = mu F_r d_m/2"
    references = ("Palmgren A. Ball and Roller Bearing Engineering. SKF Industries, 1959.",)

    def terms(self, duty):
        return {"all": 0.5 * 0.001 * duty.radial_load * duty.pitch_diameter}

@hookimpl
def torque_formulas():
    return [PitchFriction]
""",
}
