from rollslip_kernels.motion.rosenbrock import Stepper

class Leapfrog(Stepper):
    damping: float
