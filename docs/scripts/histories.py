"""Operation that changes in time: three histories of the bearing 1032930, their slip, and a figure of one.

Writes docs/tables/histories.csv and docs/figures/history_run_up.svg, in about a minute::

    python docs/scripts/histories.py
"""

import csv
from pathlib import Path

import rollslip
from rollslip.results.style import save
from rollslip.studies.dynamics.history_figures import slip_along
from rollslip.studies.dynamics.history_findings import record

DOCS = Path(__file__).parents[1]
KEY = "study.dynamics.history"
COMMON = {
    "accuracy.slices": 15,
    "study.dynamics.friction": "conventional",
    "operation.radial_load": "3000 N",
    "study.dynamics.duration": "1.5 s",
}
