# SPDX-License-Identifier: Apache-2.0
"""A quiz: click the right ball. Cards say whether it was, and a label counts."""

import iota

QUESTIONS = (
    ("Which planet is the largest?", "Jupiter"),
    ("Which one has life?", "Earth"),
    ("Which one is red?", "Mars"),
)
COLORS = {"Earth": "dodgerblue", "Jupiter": "burlywood", "Mars": "orangered"}

system = iota.System()
balls = {}
for number, (name, color) in enumerate(COLORS.items()):
    ball = system.body(shape=iota.Sphere(0.3), position=(number - 1, 0.3, 0), color=color)
    ball.name = name
    balls[name] = ball

world = iota.World(system, title="quiz")
for name, ball in balls.items():
    world.label(name, at=ball, offset=(0, 0.45, 0))
question = world.label(QUESTIONS[0][0], at=(0, 1.6, 0), height=0.12)
score = {"asked": 0, "points": 0}


@world.on_click(balls.values())
def answered(event):
    right = event.body.name == QUESTIONS[score["asked"]][1]
    score["points"] += right
    score["asked"] = (score["asked"] + 1) % len(QUESTIONS)
    event.notice("Right!" if right else "No", f"{score['points']} points")
    question.text = QUESTIONS[score["asked"]][0]


world.run()
