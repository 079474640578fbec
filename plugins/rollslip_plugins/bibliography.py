"""The publications that the models and data of the box rest on, each written once; the framework has its own.

`rollslip.references.Reference` says what a field is. A DOI stands here where a second source confirms it.
"""

from typing import Final

from rollslip.references import Reference

__all__ = [
    "AIHARA_1987",
    "ASTM_D341",
    "BAIR_2002",
    "BAIR_2019",
    "BAIR_WINER_1979",
    "BLOK_1963",
    "BOGACKI_1989",
    "CARREAU_1972",
    "CARSLAW_1959",
    "COHEN_1996",
    "CROOK_1961",
    "DORMAND_1980",
    "DOWSON_EHD_1968",
    "DOWSON_HIGGINSON_1966",
    "DOWSON_TOYODA_1979",
    "EYRING_1936",
    "GEARPIE",
    "GOKSEM_1978",
    "GOST_13076",
    "GOST_22696",
    "GREENWOOD_1961",
    "GREENWOOD_TRIPP_1970",
    "GUPTA_1984",
    "GUPTA_1992",
    "HAIRER_1993",
    "HAIRER_1996",
    "HAIRER_2003",
    "HARRIS_2006",
    "HARRIS_2007",
    "HERREBRUGH_1968",
    "HINDMARSH_2005",
    "ISO_15",
    "ISO_76",
    "ISO_286",
    "ISO_492",
    "ISO_3448",
    "ISO_5753",
    "ISO_15312",
    "ISO_16281",
    "JOHNSON_1970",
    "JOHNSON_1985",
    "JOHNSON_GREENWOOD_1980",
    "JOHNSON_TEVAARWERK_1977",
    "KRAGELSKII_1965",
    "LUNDBERG_1939",
    "MARTIN_1916",
    "MOES_1992",
    "MURAKI_1987",
    "MURAKI_1992",
    "MURCH_1975",
    "NAHME_1940",
    "PALMGREN_1959",
    "PAN_1989",
    "PARKER_1984",
    "PETROFF_1883",
    "PETZOLD_1983",
    "SAKAGUCHI_2003",
    "SHAMPINE_1997",
    "STEINEBACH_2023",
    "TU_B_3V",
    "TU_IPM_10",
    "TU_TP_22S",
    "WEBER_1954",
    "WILSON_1983",
    "WINGERTSZAHN_2023",
    "WU_1989",
    "ZHOU_1991",
]

_THROUGH_THE_PAPER: Final = "as cited by Klebanov et al. (2022)"

# Contact ------------------------------------------------------------------------------------------------------------

HARRIS_2006: Final = Reference(
    kind="book", authors=("Harris, T. A.", "Kotzalas, M. N."), title="Essential Concepts of Bearing Technology",
    edition="5th", publisher="CRC Press", year=2006,
)  # fmt: skip
JOHNSON_1985: Final = Reference(
    kind="book", authors=("Johnson, K. L.",), title="Contact Mechanics", publisher="Cambridge University Press",
    year=1985, doi="10.1017/CBO9781139171731",
)  # fmt: skip
LUNDBERG_1939: Final = Reference(
    authors=("Lundberg, G.",),
    title="Elastische Berührung zweier Halbräume",
    journal="Forsch. Geb. Ingenieurwes.",
    volume="10",
    pages="201-211",
    year=1939,
    doi="10.1007/BF02584950",
)
ISO_16281: Final = Reference(
    kind="standard",
    title="Rolling bearings: methods for calculating the modified reference rating life for universally loaded "
    "bearings",
    number="ISO/TS 16281:2008",
)

# Oils -----------------------------------------------------------------------------------------------------------------

ASTM_D341: Final = Reference(
    kind="standard",
    title="Standard practice for viscosity-temperature equations and charts for liquid petroleum products",
    number="ASTM D341",
)
ISO_15: Final = Reference(
    kind="standard", title="Rolling bearings: radial bearings, boundary dimensions, general plan", number="ISO 15"
)
ISO_76: Final = Reference(kind="standard", title="Rolling bearings: static load ratings", number="ISO 76")
ISO_286: Final = Reference(
    kind="standard", title="ISO code system for tolerances on linear sizes, parts 1 and 2", number="ISO 286"
)
ISO_492: Final = Reference(
    kind="standard", title="Rolling bearings: radial bearings, dimensional tolerances", number="ISO 492"
)
ISO_5753: Final = Reference(
    kind="standard", title="Rolling bearings: internal clearance, part 1: radial clearance", number="ISO 5753-1"
)
GOST_22696: Final = Reference(
    kind="standard", title="Rolling bearings: short cylindrical rollers", number="GOST 22696-2013"
)
ISO_3448: Final = Reference(
    kind="standard", title="Industrial liquid lubricants: ISO viscosity classification", number="ISO 3448"
)
WU_1989: Final = Reference(
    authors=("Wu, C. S.", "Klaus, E. E.", "Duda, J. L."),
    title="Development of a method for the prediction of pressure-viscosity coefficients of lubricating oils based on "
    "free-volume theory",
    journal="J. Tribol.",
    volume="111",
    pages="121-128",
    year=1989,
)
GEARPIE: Final = Reference(
    kind="software", authors=("Fernandes, C.",), title="GEARpie, a library for gear contacts",
    publisher="github.com/cfernandesFEUP/GEARpie",
)  # fmt: skip
TU_TP_22S: Final = Reference(
    kind="standard", title="Turbine oil Tp-22S", number="TU 38.101821-2001", note="known second-hand"
)
GOST_13076: Final = Reference(
    kind="standard", title="Oil VNII NP 50-1-4", number="GOST 13076-86 and TU 38.401-58-12-91",
    note="recalled, not read",
)  # fmt: skip
TU_IPM_10: Final = Reference(kind="standard", title="Oil IPM-10", number="TU 38.1011299", note="recalled, not read")
TU_B_3V: Final = Reference(kind="standard", title="Oil B-3V", number="TU 38.101295", note="recalled, not read")

# Film ---------------------------------------------------------------------------------------------------------------

MARTIN_1916: Final = Reference(
    authors=("Martin, H. M.",), title="Lubrication of gear teeth", journal="Engineering", volume="102",
    pages="119-121", year=1916,
)  # fmt: skip
WEBER_1954: Final = Reference(
    authors=("Weber, C.", "Saalfeld, K."),
    title="Schmierfilm bei Walzen mit Verformung",
    journal="ZAMM",
    volume="34",
    pages="54-64",
    year=1954,
)
BLOK_1963: Final = Reference(
    kind="proceedings",
    authors=("Blok, H.",),
    title="Inverse problems in hydrodynamic lubrication",
    journal="Proc. Int. Symp. Lubrication and Wear, Houston",
    year=1963,
    unconfirmed=("pages", "publisher"),
)
HERREBRUGH_1968: Final = Reference(
    authors=("Herrebrugh, K.",),
    title="Solving the incompressible and isothermal problem in elastohydrodynamic lubrication through an integral "
    "equation",
    journal="J. Lubr. Technol.",
    volume="90",
    pages="262-270",
    year=1968,
)
DOWSON_HIGGINSON_1966: Final = Reference(
    kind="book",
    authors=("Dowson, D.", "Higginson, G. R."),
    title="Elasto-hydrodynamic Lubrication",
    publisher="Pergamon",
    year=1966,
)
DOWSON_EHD_1968: Final = Reference(
    authors=("Dowson, D.",),
    title="Elastohydrodynamics",
    journal="Proc. Inst. Mech. Eng.",
    volume="182",
    issue="3A",
    pages="151-167",
    year=1968,
)
DOWSON_TOYODA_1979: Final = Reference(
    kind="proceedings",
    authors=("Dowson, D.", "Toyoda, S."),
    title="A central film thickness formula for elastohydrodynamic line contacts",
    journal="Proc. 5th Leeds-Lyon Symp. Tribology",
    pages="60-65",
    year=1979,
)
PAN_1989: Final = Reference(
    authors=("Pan, P.", "Hamrock, B. J."),
    title="Simple formulas for performance parameters used in elastohydrodynamically lubricated line contacts",
    journal="J. Tribol.",
    volume="111",
    pages="246-251",
    year=1989,
    doi="10.1115/1.3261900",
)
MOES_1992: Final = Reference(
    authors=("Moes, H.",),
    title="Optimum similarity analysis with applications to elastohydrodynamic lubrication",
    journal="Wear",
    volume="159",
    pages="57-66",
    year=1992,
)
JOHNSON_1970: Final = Reference(
    authors=("Johnson, K. L.",),
    title="Regimes of elastohydrodynamic lubrication",
    journal="J. Mech. Eng. Sci.",
    volume="12",
    pages="9-16",
    year=1970,
)
MURCH_1975: Final = Reference(
    authors=("Murch, L. E.", "Wilson, W. R. D."),
    title="A thermal elastohydrodynamic inlet zone analysis",
    journal="J. Lubr. Technol.",
    volume="97",
    pages="212-216",
    year=1975,
    doi="10.1115/1.3452559",
)
WILSON_1983: Final = Reference(
    authors=("Wilson, W. R. D.", "Sheu, S."),
    title="Effect of inlet shear heating due to sliding on elastohydrodynamic film thickness",
    journal="J. Lubr. Technol.",
    volume="105",
    pages="187-188",
    year=1983,
)
GUPTA_1992: Final = Reference(
    authors=("Gupta, P. K.", "Cheng, H. S.", "Zhu, D.", "Forster, N. H.", "Schrand, J. B."),
    title="Viscoelastic effects in MIL-L-7808-type lubricant, part I: analytical formulation",
    journal="Tribol. Trans.",
    volume="35",
    pages="269-274",
    year=1992,
    doi="10.1080/10402009208982117",
)
ZHOU_1991: Final = Reference(
    authors=("Zhou, R. S.", "Hoeprich, M. R."),
    title="Torque of tapered roller bearings",
    journal="J. Tribol.",
    volume="113",
    pages="590-597",
    year=1991,
    doi="10.1115/1.2920664",
)

# Traction -----------------------------------------------------------------------------------------------------------

MURAKI_1987: Final = Reference(
    authors=("Muraki, M.",),
    title="Molecular structure of synthetic hydrocarbon oils and their rheological properties governing traction "
    "characteristics",
    journal="Tribol. Int.",
    volume="20",
    issue="6",
    pages="347-354",
    year=1987,
    note=_THROUGH_THE_PAPER,
    unconfirmed=("title",),
)
MURAKI_1992: Final = Reference(
    authors=("Muraki, M.",),
    title="",
    journal="J. Synth. Lubr.",
    volume="9",
    issue="1",
    pages="29-43",
    year=1992,
    note=_THROUGH_THE_PAPER,
    unconfirmed=("authors", "title"),
)
JOHNSON_TEVAARWERK_1977: Final = Reference(
    authors=("Johnson, K. L.", "Tevaarwerk, J. L."),
    title="Shear behaviour of elastohydrodynamic oil films",
    journal="Proc. R. Soc. Lond. A",
    volume="356",
    pages="215-236",
    year=1977,
)
EYRING_1936: Final = Reference(
    authors=("Eyring, H.",),
    title="Viscosity, plasticity, and diffusion as examples of absolute reaction rates",
    journal="J. Chem. Phys.",
    volume="4",
    pages="283-291",
    year=1936,
)
CARSLAW_1959: Final = Reference(
    kind="book",
    authors=("Carslaw, H. S.", "Jaeger, J. C."),
    title="Conduction of Heat in Solids",
    edition="2nd",
    publisher="Oxford University Press",
    year=1959,
)
CROOK_1961: Final = Reference(
    authors=("Crook, A. W.",),
    title="The lubrication of rollers III. A theoretical discussion of friction and the temperatures in the oil film",
    journal="Phil. Trans. R. Soc. Lond. A",
    volume="254",
    pages="237-258",
    year=1961,
)
NAHME_1940: Final = Reference(
    authors=("Nahme, R.",),
    title="Beiträge zur hydrodynamischen Theorie der Lagerreibung",
    journal="Ingenieur-Archiv",
    volume="11",
    pages="191-209",
    year=1940,
)
JOHNSON_GREENWOOD_1980: Final = Reference(
    authors=("Johnson, K. L.", "Greenwood, J. A."),
    title="Thermal analysis of an Eyring fluid in elastohydrodynamic traction",
    journal="Wear",
    volume="61",
    pages="353-374",
    year=1980,
)
CARREAU_1972: Final = Reference(
    authors=("Carreau, P. J.",),
    title="Rheological equations from molecular network theories",
    journal="Trans. Soc. Rheol.",
    volume="16",
    pages="99-127",
    year=1972,
    doi="10.1122/1.549276",
)
BAIR_2019: Final = Reference(
    kind="book",
    authors=("Bair, S.",),
    title="High-Pressure Rheology for Quantitative Elastohydrodynamics",
    edition="2nd",
    publisher="Elsevier",
    year=2019,
)
BAIR_2002: Final = Reference(
    authors=("Bair, S.", "McCabe, C.", "Cummings, P. T."),
    title="Comparison of nonequilibrium molecular dynamics with experimental measurements in the nonlinear "
    "shear-thinning regime",
    journal="Phys. Rev. Lett.",
    volume="88",
    pages="058302",
    year=2002,
)
BAIR_WINER_1979: Final = Reference(
    authors=("Bair, S.", "Winer, W. O."),
    title="A rheological model for elastohydrodynamic contacts based on primary laboratory data",
    journal="J. Lubr. Technol.",
    volume="101",
    pages="258-265",
    year=1979,
    doi="10.1115/1.3453342",
)
KRAGELSKII_1965: Final = Reference(
    kind="book",
    authors=("Kragelskii, I. V.",),
    title="Friction and Wear",
    publisher="Butterworths",
    year=1965,
    note=_THROUGH_THE_PAPER,
)
SAKAGUCHI_2003: Final = Reference(
    authors=("Sakaguchi, T.", "Ueno, K."),
    title="Dynamic analysis of cage behavior in a cylindrical roller bearing",
    journal="NTN Tech. Rev.",
    volume="71",
    pages="8-17",
    year=2003,
)
AIHARA_1987: Final = Reference(
    authors=("Aihara, S.",),
    title="A new running torque formula for tapered roller bearings under axial load",
    journal="J. Tribol.",
    volume="109",
    pages="471-477",
    year=1987,
    doi="10.1115/1.3261475",
)
WINGERTSZAHN_2023: Final = Reference(
    authors=("Wingertszahn, P.", "Koch, O.", "Maccioni, L.", "Concli, F.", "Sauer, B."),
    title="Predicting friction of tapered roller bearings with detailed multi-body simulation models",
    journal="Lubricants",
    volume="11",
    issue="9",
    pages="369",
    year=2023,
    doi="10.3390/lubricants11090369",
)
GREENWOOD_TRIPP_1970: Final = Reference(
    authors=("Greenwood, J. A.", "Tripp, J. H."),
    title="The contact of two nominally flat rough surfaces",
    journal="Proc. Inst. Mech. Eng.",
    volume="185",
    pages="625-633",
    year=1970,
    note="volume of 1970-71",
)
GUPTA_1984: Final = Reference(
    kind="book",
    authors=("Gupta, P. K.",),
    title="Advanced Dynamics of Rolling Elements",
    publisher="Springer, New York",
    year=1984,
)

# Drag and rolling resistance ----------------------------------------------------------------------------------------

HARRIS_2007: Final = Reference(
    kind="book",
    authors=("Harris, T. A.", "Kotzalas, M. N."),
    title="Advanced Concepts of Bearing Technology",
    edition="5th",
    publisher="CRC Press",
    year=2007,
)
PETROFF_1883: Final = Reference(
    authors=("Petroff, N. P.",),
    title="Friction in machines and the effect of the lubricant",
    journal="Inzh. Zh., St. Petersburg",
    year=1883,
    unconfirmed=("volume", "pages"),
)
PARKER_1984: Final = Reference(
    kind="report",
    authors=("Parker, R. J.",),
    title="Comparison of predicted and experimental thermal performance of angular-contact ball bearings",
    publisher="NASA",
    number="TP-2275",
    year=1984,
)
GOKSEM_1978: Final = Reference(
    authors=("Goksem, P. G.", "Hargreaves, R. A."),
    title="The effect of viscous shear heating on both film thickness and rolling traction in an EHL line contact",
    journal="J. Lubr. Technol.",
    volume="100",
    pages="346-358",
    year=1978,
    doi="10.1115/1.3453183",
    note="two parts",
)
GREENWOOD_1961: Final = Reference(
    authors=("Greenwood, J. A.", "Minshall, H.", "Tabor, D."),
    title="Hysteresis losses in rolling and sliding friction",
    journal="Proc. R. Soc. Lond. A",
    volume="259",
    pages="480-507",
    year=1961,
)

# Numerical methods --------------------------------------------------------------------------------------------------

HAIRER_1993: Final = Reference(
    kind="book",
    authors=("Hairer, E.", "Nørsett, S. P.", "Wanner, G."),
    title="Solving Ordinary Differential Equations I",
    edition="2nd",
    publisher="Springer",
    year=1993,
    doi="10.1007/978-3-540-78862-1",
)
HAIRER_1996: Final = Reference(
    kind="book",
    authors=("Hairer, E.", "Wanner, G."),
    title="Solving Ordinary Differential Equations II",
    edition="2nd",
    publisher="Springer",
    year=1996,
    doi="10.1007/978-3-642-05221-7",
)
HAIRER_2003: Final = Reference(
    authors=("Hairer, E.", "Lubich, C.", "Wanner, G."),
    title="Geometric numerical integration illustrated by the Störmer-Verlet method",
    journal="Acta Numerica",
    volume="12",
    pages="399-450",
    year=2003,
    doi="10.1017/S0962492902000144",
)
BOGACKI_1989: Final = Reference(
    authors=("Bogacki, P.", "Shampine, L. F."),
    title="A 3(2) pair of Runge-Kutta formulas",
    journal="Appl. Math. Lett.",
    volume="2",
    pages="321-325",
    year=1989,
    doi="10.1016/0893-9659(89)90079-7",
)
DORMAND_1980: Final = Reference(
    authors=("Dormand, J. R.", "Prince, P. J."),
    title="A family of embedded Runge-Kutta formulae",
    journal="J. Comp. Appl. Math.",
    volume="6",
    pages="19-26",
    year=1980,
    doi="10.1016/0771-050X(80)90013-3",
)
SHAMPINE_1997: Final = Reference(
    authors=("Shampine, L. F.", "Reichelt, M. W."),
    title="The MATLAB ODE suite",
    journal="SIAM J. Sci. Comput.",
    volume="18",
    pages="1-22",
    year=1997,
    doi="10.1137/S1064827594276424",
)
PETZOLD_1983: Final = Reference(
    authors=("Petzold, L.",),
    title="Automatic selection of methods for solving stiff and nonstiff systems of ordinary differential equations",
    journal="SIAM J. Sci. Stat. Comput.",
    volume="4",
    pages="136-148",
    year=1983,
    doi="10.1137/0904010",
)
STEINEBACH_2023: Final = Reference(
    authors=("Steinebach, G.",),
    title="Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within the Julia Differential "
    "Equations package",
    journal="BIT Numer. Math.",
    volume="63",
    pages="27",
    year=2023,
    doi="10.1007/s10543-023-00967-x",
)
COHEN_1996: Final = Reference(
    authors=("Cohen, S. D.", "Hindmarsh, A. C."),
    title="CVODE, a stiff/nonstiff ODE solver in C",
    journal="Comput. Phys.",
    volume="10",
    pages="138-143",
    year=1996,
    doi="10.1063/1.4822377",
)
HINDMARSH_2005: Final = Reference(
    authors=(
        "Hindmarsh, A. C.",
        "Brown, P. N.",
        "Grant, K. E.",
        "Lee, S. L.",
        "Serban, R.",
        "Shumaker, D. E.",
        "Woodward, C. S.",
    ),
    title="SUNDIALS: suite of nonlinear and differential/algebraic equation solvers",
    journal="ACM Trans. Math. Softw.",
    volume="31",
    pages="363-396",
    year=2005,
    doi="10.1145/1089014.1089020",
)
PALMGREN_1959: Final = Reference(
    kind="book",
    authors=("Palmgren, A.",),
    title="Ball and Roller Bearing Engineering",
    edition="3rd",
    publisher="SKF Industries",
    year=1959,
    note="cited through Harris and Kotzalas (2007)",
)
ISO_15312: Final = Reference(
    kind="standard",
    title="Rolling bearings: thermal speed rating, calculation",
    number="ISO 15312:2018",
    note="its reference conditions are those that SKF prints; its flux of heat is recalled, not read",
)
