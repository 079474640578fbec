"""The contact chain beside everything a user would pick instead: time, ratio and error of the same work."""

import contextlib
import json
import math
import os
import platform
import subprocess
import sys
from pathlib import Path
from typing import ClassVar

import numpy as np

import compiled_peers
import numpy_peers
from contacts import CONTACT, FILMS, OIL, TRACTION, contacts, kinds, reference, worst_error
from report import Table, cell
from rollslip import Chain, Slices, get_model
from rollslip_kernels.stages import simd
from timing import interleaved, medians

SIZES = (16, 64, 1024, 16384, 65536)
OURS = "rollslip"
CALL = "rollslip, bound call alone"  # without the force, which all others compute too
SET_PEER = "C loop"  # what every instruction set is compared with, in its own process


def bound(film, given):
    """rollslip's chain bound to a table of slices, whose columns stay where they are."""
    slices = Slices(
        len(given.load),
        given.conditions,
        load=given.load,
        rolling_speed=given.rolling_speed,
        sliding_speed=given.sliding_speed,
    )
    return (
        Chain(CONTACT, get_model("film", film), OIL, TRACTION).bind(slices),
        slices.friction,
        slices.load,
    )


def ours(film, given):
    """The bound chain, and NumPy's dot product for the force."""
    (evaluate, friction, load) = bound(film, given)
    width = given.width

    def call():
        evaluate()
        return float(np.dot(friction, load)) * width

    return call, lambda: friction


def alone(film, given):
    """The bound chain without the force."""
    evaluate, friction, _ = bound(film, given)
    return evaluate, lambda: friction


class Peers:
    """What can be had: name -> peer, a function of film and contacts; what cannot: name -> reason."""

    #: Largest relative error of friction against 50 digits with which a peer still counts as doing the same work;
    #: textbook formulas cancel, and are held to little, and on the timed slices alone; so is the prototype, which loses
    #: small slips.
    bounds: ClassVar = {"NumPy, textbook": 1e-2, "C, prototype": 1e-12}
    bound = 1e-12

    def __init__(self, svml_python=None, only=None):
        self.ready = {OURS: ours}
        self.missing = {}
        self.closing = []
        self.notes = []
        for name, get in self.sources(svml_python).items():
            if only is not None and name not in only:
                continue
            try:
                self.ready[name] = get()
            except (
                Exception
            ) as error:  # whatever it is that keeps a peer from being there is reported
                self.missing[name] = f"{type(error).__name__}: {error}"

    def sources(self, svml_python):
        """Return name -> function that gives the peer, or fails with the reason why it cannot be had."""

        def loops(module, form):
            peer = compiled_peers.peer(module, form)
            if module == "loops_unfair":
                used = (
                    ", ".join(compiled_peers.vector_functions(compiled_peers.module(module)))
                    or "no vector function"
                )
                self.notes.append(
                    f"C, unfair: {' '.join(compiled_peers.UNFAIR)}; calls of libmvec: {used}."
                )
            return peer

        def numba():
            import numba_peer

            return numba_peer.plain

        def svml():
            import numba_peer

            if svml_python is None:
                raise RuntimeError(
                    "give --svml-python an interpreter with numba==0.61.2, the last whose LLVM has SVML, and "
                    "intel-cmplr-lib-rt"
                )
            peer = numba_peer.Elsewhere(svml_python)
            self.closing.append(peer)
            versions = ", ".join(f"{name} {version}" for name, version in peer.versions.items())
            self.notes.append(
                f"Numba, SVML: {versions}, in a process of its own; its code was seen to call SVML."
            )
            return peer

        def jax():
            import jax_peer

            return jax_peer.jitted

        return {
            "NumPy, textbook": lambda: numpy_peers.textbook,
            "NumPy, in place": lambda: numpy_peers.careful,
            "Numba": numba,
            "Numba, SVML": svml,
            "JAX": jax,
            "Cython loop": lambda: loops("loops", "cython"),
            SET_PEER: lambda: loops("loops", "with branches"),
            "C, unfair": lambda: loops("loops_unfair", "without branches"),
            "C, prototype": lambda: loops("loops_prototype", "prototype"),
        }

    def check(self, film):
        """Return name -> (error on the timed slices, error over all branches); drop who does other work."""
        errors = {}
        for name, peer in list(self.ready.items()):
            found = {}
            try:
                with np.errstate(
                    all="ignore"
                ):  # the textbook divides by zero where its result is not used
                    for given, friction in reference(film)[0]:
                        call, values = peer(film, given)
                        force = call()
                        found[given.name] = worst_error(friction, np.array(values()))
                        want = math.fsum(
                            float(mu) * w for mu, w in zip(friction, given.load, strict=True)
                        )
                        scale = math.fsum(
                            abs(float(mu)) * w for mu, w in zip(friction, given.load, strict=True)
                        )
                        apart = abs(force / given.width - want) / scale
                        if given.name == "timed":
                            found["timed"] = max(found["timed"], apart)
            except (
                Exception
            ) as error:  # a peer that fails is reported, and does not stop the others
                del self.ready[name]
                self.missing[name] = f"fails: {type(error).__name__}: {error}"
                continue
            timed = found["timed"]
            every = max(found.values())
            bound = self.bounds.get(name, self.bound)
            kept = timed if name in self.bounds else every
            if not kept <= bound:
                del self.ready[name]
                self.missing[name] = (
                    f"does other work: its friction errs by {kept:.1e}, allowed is {bound:.0e}"
                )
            errors[name] = timed, every
        return errors

    def close(self):
        """End what runs elsewhere."""
        for peer in self.closing:
            peer.close()


def times(peers, film, given, rounds):
    """Return key -> name -> (median time [s], ratio to ours) of contacts by key."""
    found = {}
    for key, slices in given.items():
        with np.errstate(all="ignore"):
            calls = {name: peer(film, slices)[0] for name, peer in peers.ready.items()}
            found[key] = medians(interleaved(calls, rounds), OURS)
    return found


def by_kind(peers, rounds, n=1024):
    """Return the table of all peers for films of one kind."""
    found = times(peers, FILMS[0], kinds(n), rounds)
    rows = [
        (name, *(cell(1e9 * found[kind][name][0] / n, found[kind][name][1]) for kind in found))
        for name in peers.ready
    ]
    title = (
        f"Contact chain with film {FILMS[0]} by kind of film, N = {n}: ns per slice (ratio to ours)"
    )
    return Table("benchmark_kinds", title, ("", *found), rows)


def run(quick=False, svml_python=None):
    """Return the tables: each chain with all peers, and our instruction sets."""
    sizes, rounds = (SIZES[:3], 5) if quick else (SIZES, 21)
    peers = Peers(svml_python)
    tables = []
    try:
        for film in FILMS:
            peers.ready.pop(CALL, None)
            errors = peers.check(film)
            peers.ready = {OURS: ours, CALL: alone, **peers.ready}
            errors[CALL] = errors[OURS]
            found = times(peers, film, {n: contacts(n) for n in sizes}, rounds)
            rows = [
                (
                    name,
                    *(cell(1e9 * found[n][name][0] / n, found[n][name][1]) for n in sizes),
                    *(f"{error:.0e}" for error in errors[name]),
                )
                for name in peers.ready
            ]
            rows += [(name, *("-",) * (len(sizes) + 2)) for name in peers.missing]
            header = ("", *(f"N = {n}" for n in sizes), "error, timed", "error, all branches")
            title = f"Contact chain with film {film}: ns per slice (ratio to ours), largest relative error of friction"
            counts = ", ".join(
                f"{name} {count}" for name, count in sorted(reference(film)[1].items())
            )
            notes = [f"Slices behind the last column, by branch: {counts}."]
            tables.append(Table(f"benchmark_{film}", title, header, rows, notes))
        tables.append(by_kind(peers, rounds))
    finally:
        peers.close()
    tables[0].notes[:0] = peers.notes + [
        f"Not measured: {name}: {why}" for name, why in peers.missing.items()
    ]
    return [*tables, sets(sizes, rounds)]


# Instruction sets -----------------------------------------------------------------------------------------------------


def in_this_set(sizes, rounds):
    """Return film -> size -> [our time [s], ratio of the C loop to it], of the set that is active."""
    peers = Peers(only={SET_PEER})
    base = SET_PEER if SET_PEER in peers.ready else OURS
    return {
        film: {
            n: [found[OURS][0], found[base][1]]
            for n, found in times(peers, film, {n: contacts(n) for n in sizes}, rounds).items()
        }
        for film in FILMS
    }


def sets(sizes, rounds):
    """Return the table of all instruction sets, each in a process of its own."""
    rows = []
    environment = dict(os.environ)
    with contextlib.suppress(RuntimeError):  # without a compiler there is no C loop beside ours
        environment[compiled_peers.BUILT] = str(compiled_peers.built())
    for name in simd.available():
        code = f"import json, bench_chain; print(json.dumps(bench_chain.in_this_set({sizes!r}, {rounds!r})))"
        path = os.pathsep.join(filter(None, (*map(str, sys.path), os.environ.get("PYTHONPATH"))))
        done = subprocess.run(
            [sys.executable, "-c", code],
            env=environment | {"ROLLSLIP_SIMD": name, "PYTHONPATH": path},
            cwd=Path(__file__).parent,
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            rows += [(name, film, *("failed",) * len(sizes)) for film in FILMS]
            print(done.stderr, file=sys.stderr)
            continue
        for film, found in json.loads(done.stdout.splitlines()[-1]).items():
            cells = (cell(1e9 * seconds / int(n), ratio) for n, (seconds, ratio) in found.items())
            rows.append((name, film, *cells))
    return Table(
        "benchmark_sets",
        f"Instruction sets of {platform.machine()}: ns per slice of ours (times the C loop takes as long)",
        ("set", "film", *(f"N = {n}" for n in sizes)),
        rows,
        ["Each set in a process of its own (ROLLSLIP_SIMD), with the scalar C loop beside it."],
    )
