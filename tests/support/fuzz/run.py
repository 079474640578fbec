"""Fuzz a target guided by coverage: ``python tests/support/fuzz/run.py scene CORPUS -max_total_time=300``.

Needs atheris (Linux). CORPUS is a folder that keeps what reached something new; options are those of libFuzzer. A fault
is written to ``crash-...`` or ``timeout-...``, to be run again by giving that file in place of the folder.

Kernels guide it too if clang builds them with ``-fsanitize=fuzzer-no-link``, and libFuzzer is loaded before them:

    CC=clang LDSHARED="clang -shared" CFLAGS="-O1 -g -fsanitize=fuzzer-no-link" python setup.py build_ext --inplace
    LD_PRELOAD=$(python -c "import atheris; print(atheris.path())")/ubsan_with_fuzzer.so \\
        python tests/support/fuzz/run.py stages
"""

import random
import sys
import tempfile
from pathlib import Path

import atheris

sys.path.insert(0, str(Path(__file__).parents[1]))
with atheris.instrument_imports(include=["rollslip", "rollslip_plugins", "tomllib"]):
    from fuzz.targets import TARGETS


def main(name, *options):
    """Run libFuzzer, which ends the process."""
    target = TARGETS[name]

    def mutate(data, max_size, seed):
        """Half of the changes know the format, the others are libFuzzer's own, guided by what was compared."""
        if seed % 2:
            return atheris.Mutate(data, max_size)
        return target.mutate(random.Random(seed), data)[:max_size]

    target.run(target.seeds[0])  # loads what is loaded late, so that it counts from the start
    seeds = Path(tempfile.mkdtemp(prefix="rollslip-seeds-"))
    for number, seed in enumerate(target.seeds):
        (seeds / str(number)).write_bytes(seed)
    limits = ["-timeout=10", "-rss_limit_mb=2048", "-max_len=40000"]
    atheris.Setup([sys.argv[0], *limits, *options, str(seeds)], target.run, custom_mutator=mutate)
    atheris.Fuzz()


if __name__ == "__main__":
    main(*sys.argv[1:])
