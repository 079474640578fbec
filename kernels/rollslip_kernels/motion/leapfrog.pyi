from rollslip_kernels.motion.rosenbrock import Stepper

class Leapfrog(Stepper):
    damping: float
    renewals: int
    @property
    def told(self) -> dict[str, float]: ...
