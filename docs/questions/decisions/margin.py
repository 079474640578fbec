"""
How much slip may be allowed?
=============================

The properties of an oil scatter. Each sample of them has its own slip at which the cage runs away. The allowable slip
is below nine of ten of those. A decision takes more samples than the 128 of this page.
"""

import matplotlib.pyplot as plt
import numpy as np

import rollslip

found = rollslip.uncertainty("1032930-70C", samples=128, probability=0.9)
slip = 100 * found.value.sel(quantity="slip of running away").values
slip = np.sort(slip[np.isfinite(slip)])

fig, axes = plt.subplots()
axes.step(slip, np.linspace(0, 1, len(slip)), where="post", label="samples")
axes.axvspan(100 * float(found.allowable_low), 100 * float(found.allowable_high), color="C1", alpha=0.3, lw=0)
axes.axvline(100 * float(found.allowable_slip), color="C1", label="allowable at 90 %, with its interval")
axes.set(xlabel="Cage slip at which the cage runs away [%]", ylabel="Share of samples [–]", ylim=(0, 1))
axes.legend()
print(f"allowable slip {100 * float(found.allowable_slip):.1f} %")
