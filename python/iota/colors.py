# SPDX-License-Identifier: Apache-2.0
"""Colors as scripts write them, wherever one is taken: the names of CSS, "#rrggbb", 0xRRGGBB, or numbers from 0 to 1."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from numbers import Integral
from typing import Any, TypeAlias

import numpy as np

from iota.arguments import SHORT, is_number, suggestion

ColorLike: TypeAlias = str | int | Sequence[float]  # see `rgba`
WORDS = '"#rrggbb", a name such as "tomato", 0xRRGGBB, or 3 or 4 numbers from 0 to 1'

# https://www.w3.org/TR/css-color-4/#named-colors
CSS = """
aliceblue f0f8ff, antiquewhite faebd7, aqua 00ffff, aquamarine 7fffd4, azure f0ffff, beige f5f5dc, bisque ffe4c4, black
000000, blanchedalmond ffebcd, blue 0000ff, blueviolet 8a2be2, brown a52a2a, burlywood deb887, cadetblue 5f9ea0,
chartreuse 7fff00, chocolate d2691e, coral ff7f50, cornflowerblue 6495ed, cornsilk fff8dc, crimson dc143c, cyan 00ffff,
darkblue 00008b, darkcyan 008b8b, darkgoldenrod b8860b, darkgray a9a9a9, darkgreen 006400, darkgrey a9a9a9, darkkhaki
bdb76b, darkmagenta 8b008b, darkolivegreen 556b2f, darkorange ff8c00, darkorchid 9932cc, darkred 8b0000, darksalmon
e9967a, darkseagreen 8fbc8f, darkslateblue 483d8b, darkslategray 2f4f4f, darkslategrey 2f4f4f, darkturquoise 00ced1,
darkviolet 9400d3, deeppink ff1493, deepskyblue 00bfff, dimgray 696969, dimgrey 696969, dodgerblue 1e90ff, firebrick
b22222, floralwhite fffaf0, forestgreen 228b22, fuchsia ff00ff, gainsboro dcdcdc, ghostwhite f8f8ff, gold ffd700,
goldenrod daa520, gray 808080, green 008000, greenyellow adff2f, grey 808080, honeydew f0fff0, hotpink ff69b4, indianred
cd5c5c, indigo 4b0082, ivory fffff0, khaki f0e68c, lavender e6e6fa, lavenderblush fff0f5, lawngreen 7cfc00, lemonchiffon
fffacd, lightblue add8e6, lightcoral f08080, lightcyan e0ffff, lightgoldenrodyellow fafad2, lightgray d3d3d3, lightgreen
90ee90, lightgrey d3d3d3, lightpink ffb6c1, lightsalmon ffa07a, lightseagreen 20b2aa, lightskyblue 87cefa,
lightslategray 778899, lightslategrey 778899, lightsteelblue b0c4de, lightyellow ffffe0, lime 00ff00, limegreen 32cd32,
linen faf0e6, magenta ff00ff, maroon 800000, mediumaquamarine 66cdaa, mediumblue 0000cd, mediumorchid ba55d3,
mediumpurple 9370db, mediumseagreen 3cb371, mediumslateblue 7b68ee, mediumspringgreen 00fa9a, mediumturquoise 48d1cc,
mediumvioletred c71585, midnightblue 191970, mintcream f5fffa, mistyrose ffe4e1, moccasin ffe4b5, navajowhite ffdead,
navy 000080, oldlace fdf5e6, olive 808000, olivedrab 6b8e23, orange ffa500, orangered ff4500, orchid da70d6,
palegoldenrod eee8aa, palegreen 98fb98, paleturquoise afeeee, palevioletred db7093, papayawhip ffefd5, peachpuff ffdab9,
peru cd853f, pink ffc0cb, plum dda0dd, powderblue b0e0e6, purple 800080, rebeccapurple 663399, red ff0000, rosybrown
bc8f8f, royalblue 4169e1, saddlebrown 8b4513, salmon fa8072, sandybrown f4a460, seagreen 2e8b57, seashell fff5ee, sienna
a0522d, silver c0c0c0, skyblue 87ceeb, slateblue 6a5acd, slategray 708090, slategrey 708090, snow fffafa, springgreen
00ff7f, steelblue 4682b4, tan d2b48c, teal 008080, thistle d8bfd8, tomato ff6347, turquoise 40e0d0, violet ee82ee, wheat
f5deb3, white ffffff, whitesmoke f5f5f5, yellow ffff00, yellowgreen 9acd32
"""
NAMES = {name: int(digits, 16) for name, digits in map(str.split, CSS.split(","))}
SLACK = 1e-6  # of a number from 0 to 1 that was calculated


def rgba(color: Any) -> tuple[float, float, float, float]:
    """Red, green, blue and opacity, each from 0 to 1. color: a name of CSS, "#rgb", "#rrggbb" or "#rrggbbaa" (aa: 00 is
    invisible), 0xRRGGBB, or three or four numbers from 0 to 1. Raises ValueError, TypeError for another type."""
    if isinstance(color, str):
        return _of_text(color)
    if is_whole(color):
        number = int(color)
        if not 0 <= number <= 0xFFFFFF:
            raise ValueError(f"a color is from 0 to 0xFFFFFF, not {number:#x}")
        return (*_shares(number), 1.0)
    parts = tuple(color) if isinstance(color, Iterable) else ()
    if len(parts) not in (3, 4) or not all(is_number(part) for part in parts):
        raise TypeError(f"a color is {WORDS}, not {SHORT.repr(color)}")
    numbers = [float(part) for part in parts]
    if not all(-SLACK <= number <= 1 + SLACK for number in numbers):  # also nan
        hint = ""
        if (
            all(map(math.isfinite, numbers))
            and max(numbers) > 2
            and all(n == round(n) and 0 <= n <= 255 for n in numbers)
        ):
            hint = f'; did you mean "#{"".join(f"{round(number):02x}" for number in numbers)}"?'
        raise ValueError(f"the numbers of a color are from 0 to 1, not {SHORT.repr(color)}{hint}")
    red, green, blue, alpha = (*(min(max(number, 0.0), 1.0) for number in numbers), 1.0)[:4]
    return red, green, blue, alpha


def is_whole(value: Any) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool | np.bool_)


def color_number(color: Any) -> int:
    """0xRRGGBB, with the transparency (0: opaque) in the highest byte. color: see `rgba`."""
    red, green, blue, alpha = (round(255 * part) for part in rgba(color))
    return (255 - alpha) << 24 | red << 16 | green << 8 | blue


def opaque_number(color: Any) -> int:
    """0xRRGGBB. color: see `rgba`. Raises ValueError for one that is seen through."""
    number = color_number(color)
    if number > 0xFFFFFF:
        raise ValueError(f"a body's color has no opacity: give it a look, as in looks.solid('paint', color={color!r})")
    return number


def color_text(color: Any) -> str:
    """As "#rrggbb" or "#rrggbbaa". color: see `rgba`."""
    number = color_number(color)
    alpha = 255 - (number >> 24)
    return f"#{number & 0xFFFFFF:06x}" + (f"{alpha:02x}" if alpha < 255 else "")


def _shares(rgb: int) -> tuple[float, float, float]:
    return (rgb >> 16 & 255) / 255, (rgb >> 8 & 255) / 255, (rgb & 255) / 255


def _of_text(text: str) -> tuple[float, float, float, float]:
    named = NAMES.get("".join(text.lower().split()))
    if named is not None:
        return (*_shares(named), 1.0)
    digits = text.removeprefix("#")
    if text == digits:
        raise ValueError(f"a color is {WORDS}, not {SHORT.repr(text)}{suggestion(text.lower(), list(NAMES))}")
    if len(digits) in (3, 4):
        digits = "".join(2 * digit for digit in digits)
    if len(digits) not in (6, 8) or not all(digit in "0123456789abcdefABCDEF" for digit in digits):
        raise ValueError(f'a color is "#rrggbb" or "#rrggbbaa", not {SHORT.repr(text)}')
    return (*_shares(int(digits[:6], 16)), int(digits[6:] or "ff", 16) / 255)
