# SPDX-License-Identifier: Apache-2.0
"""All verifications, in the order of the report. A new one is a function that takes a Run, and a line here."""

from iota.verify.cases import (
    accuracy,
    chains,
    classical,
    conservation,
    contact,
    dominoes,
    friction,
    gyres,
    held,
    impacts,
    linkages,
    newton,
    shafts,
    sizes,
    sleep,
    stacks,
    tops,
)
from iota.verify.run import Case

CASES = [
    Case(check.__name__.replace("_", "-"), check)
    for check in (
        chains.lissajous,
        chains.falling_chain,
        chains.divergence,
        newton.newton_fractal,
        newton.failure_rate,
        classical.pendulum,
        classical.double_pendulum,
        accuracy.accurate,
        tops.asymmetric_top,
        tops.heavy_top,
        classical.catenary,
        linkages.four_bar,
        linkages.jansen,
        classical.spring_chain,
        classical.orbit,
        classical.oscillator,
        held.held_forces,
        shafts.fast_shafts,
        shafts.motors,
        conservation.momenta,
        accuracy.angular_momentum,
        conservation.energy,
        conservation.heavy_end,
        sizes.scales,
        sizes.places,
        sizes.masses,
        sizes.conflicts,
        sleep.sleep,
        contact.contact,
        friction.friction,
        impacts.impacts,
        stacks.stacks,
        gyres.spinning,
        dominoes.dominoes,
    )
]
