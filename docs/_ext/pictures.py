"""How the pictures of the gallery look; sphinx-gallery calls `reset` before each script."""

import matplotlib.pyplot as plt
from matplotlib import cycler

#: Those of rollslip.results.style, told apart with every kind of colour vision.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#C07F00", "#3A92C8")


def reset(gallery_conf, fname):
    """Forget what an earlier script set."""
    plt.close("all")
    plt.rcdefaults()
    plt.rcParams.update(
        {
            "axes.prop_cycle": cycler(color=COLOURS),
            "axes.spines.top": False,
            "axes.spines.right": False,
            "figure.constrained_layout.use": True,
            "figure.figsize": (5.6, 3.4),
            "font.size": 9.0,
            "legend.frameon": False,
        }
    )
