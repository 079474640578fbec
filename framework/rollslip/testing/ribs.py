"""Rules of the conformance kit for the friction of ribs."""

import attrs
import numpy as np

from rollslip.bearing.assembly import assemble
from rollslip.models import RibContact, RibModel
from rollslip.scene.reading import load_scene
from rollslip.search import Array
from rollslip.testing.rules import CITATIONS_WANTED, is_citation, refuse_unless, rule

#: Number of random contacts. Doubling it doubles the time of the checks and finds rarer faults. Chosen.
_DRAWN = 200
#: Rounding of a friction, relative to it [1]. Doubling it accepts the same models: a wrong sign is larger by orders.
_ROUNDING = 1e-9
#: Largest coefficient of friction of a loaded rib [1]. Boundary friction of steel in oil has 0.1 to 0.15 (B), dry steel
#: up to 0.8 (B); with some newtons the drag of the oil beside the contact adds to it. Doubling it accepts a force in a
#: unit ten times too small. Chosen.
_MAX_COEFFICIENT = 1.0
#: Largest friction at a sliding speed of 1e-5 m/s, relative to that at the drawn ones of 1 cm/s and more: above it the
#: friction jumps. Chosen; that of a law that is smooth over 0.01 m/s is 1e-3.
_MAX_JUMP = 0.05


def _contacts() -> RibContact:
    """Return random contacts with a rib of a usual bearing: forces of 1 N to 2 kN, speeds of 1 cm/s to 20 m/s."""
    random = np.random.default_rng(3)
    conditions = assemble(load_scene("gearbox")).inner.conditions
    rolling = 10.0 ** random.uniform(-1.0, 1.3, _DRAWN)
    return RibContact(
        conditions=attrs.evolve(conditions, radius=0.9, length=2e-3),
        load=10.0 ** random.uniform(0.0, 3.3, _DRAWN),
        rolling_speed=rolling,
        sliding_speed=rolling * 10.0 ** random.uniform(-1.0, 0.3, _DRAWN),
    )


def _friction(model: RibModel, contact: RibContact) -> Array:
    """Return the friction, a finite number for each contact."""
    friction = np.asarray(model.friction(contact), dtype=float)
    refuse_unless(
        friction.shape == contact.load.shape and np.all(np.isfinite(friction)),
        f"friction() has the shape {friction.shape} and {np.count_nonzero(~np.isfinite(friction))} values that are not "
        f"finite; return a finite force for each of {contact.load.size} contacts",
    )
    return friction


def _at(contact: RibContact, k: int) -> str:
    """Return a description of a contact."""
    return (
        f"at {contact.load[k]:.4g} N, rolling at {contact.rolling_speed[k]:.4g} m/s and sliding at "
        f"{contact.sliding_speed[k]:.4g} m/s"
    )


@rule(RibModel)
def check_a_rib_has_an_equation_and_references(model: RibModel) -> None:
    """A name, an equation, and references."""
    refuse_unless(isinstance(model.equation, str) and model.equation.strip(), "it has no equation")
    refuse_unless(model.references and all(map(is_citation, model.references)), CITATIONS_WANTED)


@rule(RibModel)
def check_rib_friction_takes_power_and_is_odd_in_the_sliding_speed(model: RibModel) -> None:
    """Friction is against the sliding, and the same for either sense; it vanishes without sliding."""
    contact = _contacts()
    friction = _friction(model, contact)
    k = int(np.argmin(friction))
    refuse_unless(
        friction[k] >= 0.0, f"a force of {friction[k]:.4g} N drives the rib {_at(contact, k)}"
    )
    other = _friction(model, attrs.evolve(contact, sliding_speed=-contact.sliding_speed))
    difference = np.abs(other + friction) - _ROUNDING * np.abs(friction)
    k = int(np.argmax(difference))
    refuse_unless(
        difference[k] <= 0.0,
        f"{friction[k]:.6g} N become {other[k]:.6g} N where the rib slides the other way, {_at(contact, k)}",
    )
    rest = _friction(model, attrs.evolve(contact, sliding_speed=0.0 * contact.sliding_speed))
    k = int(np.argmax(np.abs(rest)))
    refuse_unless(rest[k] == 0.0, f"{rest[k]:.4g} N act without sliding, {_at(contact, k)}")


@rule(RibModel)
def check_rib_friction_rises_with_the_load(model: RibModel) -> None:
    """A rib that is pressed more rubs no less."""
    contact = _contacts()
    friction = _friction(model, contact)
    more = _friction(model, attrs.evolve(contact, load=1.1 * contact.load))
    fall = friction - more - _ROUNDING * friction
    k = int(np.argmax(fall))
    refuse_unless(
        fall[k] <= 0.0,
        f"{friction[k]:.6g} N fall to {more[k]:.6g} N as the load rises by a tenth, {_at(contact, k)}",
    )


@rule(RibModel)
def check_rib_friction_has_no_jump_where_the_sliding_ends(model: RibModel) -> None:
    """A roller whose ribs roll has a balance of its torques: friction passes zero without a jump."""
    contact = _contacts()
    usual = _friction(model, contact)
    slow = _friction(model, attrs.evolve(contact, sliding_speed=1e-5 * np.ones(_DRAWN)))
    jump = slow - _MAX_JUMP * usual
    k = int(np.argmax(jump))
    refuse_unless(
        jump[k] <= 0.0,
        f"{slow[k]:.4g} N act at a sliding speed of 1e-5 m/s, and {usual[k]:.4g} N {_at(contact, k)}; make the sign "
        "smooth, tanh(V/V0) for example",
    )


@rule(RibModel)
def check_rib_friction_is_less_than_the_load(model: RibModel) -> None:
    """Loads of 100 N and more: a coefficient above 1 is one in a wrong unit."""
    contact = _contacts()
    coefficient = np.where(contact.load >= 100.0, _friction(model, contact) / contact.load, 0.0)
    k = int(np.argmax(coefficient))
    refuse_unless(
        coefficient[k] <= _MAX_COEFFICIENT,
        f"the coefficient of friction is {coefficient[k]:.4g} {_at(contact, k)}; at most {_MAX_COEFFICIENT:g} is "
        "possible",
    )
