"""What a call costs, what the exact stress costs beside the closed form, and when a second thread pays."""

import os
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import attrs
from mpmath import mp, mpf

from bench_chain import SET_PEER, Peers, ours
from contacts import CONTACT, OIL, TRACTION, contacts, samples, worst_error
from fifty_digits import DIGITS, LAWS
from report import Table, cell, number
from rollslip import Chain, Slices, get_model
from timing import interleaved, medians

LAWS_OF_STRESS = {
    "muraki": get_model("traction", "muraki"),
    "eyring": get_model("traction", "eyring"),
    "maxwell-eyring": get_model("traction", "maxwell-eyring"),
}
FILM = get_model("film", "moes")


def table(given):
    """A table of slices."""
    columns = {name: getattr(given, name) for name in ("load", "rolling_speed", "sliding_speed")}
    return Slices(len(given.load), given.conditions, **columns)


def stress_error(model):
    """Return the largest relative error of a law alone, at the very floats that it got."""
    worst = 0.0
    before = Chain(CONTACT, FILM, OIL)
    for given in samples(32):
        slices = table(given)
        before(slices)
        Chain(model)(slices)
        members = {name: mpf(value) for name, value in attrs.asdict(given.conditions).items()}
        with mp.workdps(DIGITS):
            friction = [
                LAWS[model.name](
                    model,
                    members
                    | {
                        name: mpf(float(getattr(slices, name)[i]))
                        for name in model.reads - set(members)
                    },
                )["friction"]
                for i in range(len(slices))
            ]
        worst = max(worst, worst_error(friction, slices.friction))
    return worst


def stresses(rounds, n=1024):
    """Return the table of the laws of stress, alone and in the chain."""
    before = Chain(CONTACT, FILM, OIL)
    alone = {}
    inside = {}
    for name, model in LAWS_OF_STRESS.items():
        slices = table(contacts(n))
        before(slices)
        alone[name] = partial(Chain(model), slices)
        blend = get_model(
            "traction", "lambda-blend", hydrodynamic=model, boundary=TRACTION.boundary
        )
        inside[name] = partial(Chain(CONTACT, FILM, OIL, blend), table(contacts(n)))
    times = [medians(interleaved(calls, rounds), "muraki") for calls in (alone, inside)]
    rows = [
        (name, *(cell(1e9 * found[name][0] / n, found[name][1]) for found in times), f"{error:.0e}")
        for name, error in ((name, stress_error(model)) for name, model in LAWS_OF_STRESS.items())
    ]
    header = ("law", "alone", "in the chain", "error, all branches")
    title = (
        f"Hydrodynamic traction: ns per slice at N = {n} (ratio to muraki), largest relative error"
    )
    return Table("benchmark_stress", title, header, rows)


def overhead(rounds, sizes=(1, 16, 256)):
    """Return the table of ways to call a chain."""
    peers = Peers(only={SET_PEER, "NumPy, in place"})
    rows = {}
    for n in sizes:
        given = contacts(n)
        chain = Chain(CONTACT, FILM, OIL, TRACTION)
        same = table(given)

        def fresh(given=given, chain=chain):
            chain(table(given))

        def refilled(given=given, chain=chain, same=same):
            same.load[:] = given.load
            same.rolling_speed[:] = given.rolling_speed
            same.sliding_speed[:] = given.sliding_speed
            chain(same)

        ways = {
            "chain(slices), the same table": partial(chain, same),
            "chain.bind(slices)(), the same table": chain.bind(same),
            "chain(slices), its three inputs written": refilled,
            "chain(Slices(...)), a new table": fresh,
            "with the friction force": ours("moes", given)[0],
            **{
                name: peer("moes", given)[0]
                for name, peer in peers.ready.items()
                if peer is not ours
            },
        }
        for name, (seconds, ratio) in medians(interleaved(ways, rounds), next(iter(ways))).items():
            rows.setdefault(name, []).append(cell(1e6 * seconds, ratio))
    return Table(
        "benchmark_calls",
        "One call of the chain with film moes: µs (ratio to the first row)",
        ("way", *(f"N = {n}" for n in sizes)),
        [(name, *cells) for name, cells in rows.items()],
    )


def threads(rounds, sizes=(256, 1024, 4096, 16384, 65536)):
    """Return the table of two load cases, one after the other and in two threads, and of one that two threads share."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    if cores < 2:
        return Table(
            "benchmark_threads", "Two threads", ("",), [], ["One core only: not measured."]
        )
    rows = []
    with ThreadPoolExecutor(2) as pool:
        for n in sizes:
            chains = [Chain(CONTACT, FILM, OIL, TRACTION, threads=1) for _ in range(2)]
            whole = Chain(CONTACT, FILM, OIL, TRACTION, threads=2)
            tables = [table(contacts(n)) for _ in chains]

            def after(chains=chains, tables=tables):
                for chain, slices in zip(chains, tables, strict=True):
                    chain(slices)

            def beside(chains=chains, tables=tables):
                for done in [
                    pool.submit(chain, slices) for chain, slices in zip(chains, tables, strict=True)
                ]:
                    done.result()

            def shared(whole=whole, tables=tables):
                for slices in tables:
                    whole(slices)

            ways = {"after": after, "beside": beside, "shared": shared}
            spent = medians(interleaved(ways, rounds), "after")
            wall = {
                name: t.min()
                for name, t in interleaved(ways, 3 * rounds, clock=time.perf_counter).items()
            }
            price = (spent["beside"][0] - spent["after"][0]) / 2
            cells = [
                1e6 * spent["after"][0] / 2,
                1e6 * price,
                *(wall["after"] / wall[way] for way in list(ways)[1:]),
            ]
            rows.append((n, *map(number, cells)))
    return Table(
        "benchmark_threads",
        f"Two load cases in one thread, in two, and one after the other shared by two, {cores} cores",
        (
            "slices of a case", "its time, µs", "price of handing it over, µs", "two threads are faster by",
            "sharing each is faster by",
        ),
        rows,
        ["The price is that of the processor; times are medians, the last columns of the fastest of all rounds."],
    )  # fmt: skip


def run(quick=False):
    """Return the tables."""
    rounds = 5 if quick else 21
    return [stresses(rounds), overhead(rounds)]
