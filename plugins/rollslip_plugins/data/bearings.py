"""The built-in bearings; each ``source`` states where the values come from, with the grade (D) for an estimate."""

from rollslip.datasets import BearingData
from rollslip.references import KLEBANOV
from rollslip.scene import Bearing, Profile
from rollslip_plugins.data import PROFILE_DEPTH

bearing_1032930 = BearingData(
    name="1032930",
    description="Cylindrical roller bearing 1032930, 150 x 210 x 28 mm, 28 rollers of 15 x 15 mm",
    source=(
        "Number and size of rollers and diameters of raceways: the paper. Clearance: nominal, from these diameters; "
        "the paper states none. Profile: that of ISO/TS 16281 for rollers of unknown profile (D); the paper prints "
        "none. Material: bearing steel."
    ),
    validity="Before mounting: fits, speed and temperature change the clearance; a scene gives the one in operation.",
    references=(KLEBANOV,),
    bearing=Bearing(
        rollers=28,
        roller_diameter=0.015,
        roller_length=0.015,
        inner_raceway_diameter=0.165,
        outer_raceway_diameter=0.195,
        profile=Profile(shape="iso16281"),
    ),
    grades={"profile": "D"},
    scatter=(PROFILE_DEPTH,),
)
