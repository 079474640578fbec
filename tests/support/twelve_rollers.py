"""The shipped bearing with fewer rollers and slices, for tests of study dynamics at every level and friction."""

from rollslip import evolve, load_scene
from rollslip.bearing.assembly import assemble

SHIPPED = load_scene("1032930-50C")
#: Key of the largest slip of the search for the onset of skidding, which takes longer than a short motion.
RANGE_KEY = "study.effective-friction.skidding_range"
#: Fewer rollers than its 28, few slices, and no search for the onset of skidding.
FAST = {"bearing.rollers": 12, "accuracy.slices": 5, "accuracy.tolerance": 1e-2, RANGE_KEY: 0.0}
#: With that search, up to its usual largest slip.
WITH_SKIDDING = {RANGE_KEY: 0.95}
LEVELS = ("cage-set", "pocket", "planar")
FRICTIONS = ("constant", "effective", "conventional")
#: Moment of inertia of the cage [kg m2], as shipped.
INERTIA = 3.3e-3
MADE = {}


def bearing(*drags, cage=None, **changes):
    """Return that bearing with these drags; made once."""
    key = repr((drags, cage, changes))
    if key not in MADE:
        own = {"mass": 0.4, "inertia": INERTIA, "drag": list(drags)} | (cage or {})
        MADE[key] = assemble(evolve(SHIPPED, {"cage": own} | FAST | changes, si=True))
    return MADE[key]
