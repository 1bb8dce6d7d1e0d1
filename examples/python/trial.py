# SPDX-License-Identifier: Apache-2.0
"""Repeats the trial of the thesis, §5.8: visitors try a study and say what they think of its motion.

python examples/python/trial.py cradle      their answers are rows of answers.csv
"""

import sys

from iota import studies

# Fifteen people saw these studies then, and were asked the first question about each.
ASKED = "cradle", "ladder", "shoal", "undersea", "chain", "molecule", "soft-molecule", "bucky", "lab"

named = [name for name in sys.argv[1:] if name in ASKED]
world = studies.module(named[0] if named else "cradle").build()
world.ask(
    {
        "What was your impression of the motion?": str,
        "Was it plausible?": ["yes", "partly", "no"],
        "How sure are you, from 0 to 10?": (0, 10),
    },
    file="answers.csv",
    purpose="We want to know whether people find simulated motion plausible.",
)
world.run()
