# SPDX-License-Identifier: Apache-2.0
"""Notes about all of an MJCF file that is not taken over. The rule is the other way round than a list of what is missing: a table says
what is taken of each kind of element, and everything else that differs from its default is noted, also what a later MuJoCo adds."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from iota.shapelib.trees import Element

MOST_NAMED = 5
Predicate = Callable[[Any], bool]
Taken = dict[str, Predicate | None]


def _first_only(name: str) -> Predicate:
    """Whether a spring or damper of a hinge or slide is linear."""

    def is_taken(joint: Any) -> bool:
        return _has_axis(joint) and not any(np.ravel(getattr(joint, name))[1:])

    return is_taken


def _has_axis(joint: Any) -> bool:
    return int(joint.type) in (2, 3)  # mjJNT_SLIDE, mjJNT_HINGE


def _all(names: str) -> Taken:
    return dict.fromkeys(names.split(), None)


# Attributes without effect on the world: names, order, and what MuJoCo has used up when the model is built.
NO_EFFECT = {
    "alt", "authored", "childclass", "classname", "compiler", "comment", "default", "frame", "fuse", "group", "ialt", "id", "info",
    "name", "parent", "signature", "simple", "userdata",
    "bodies", "cameras", "frames", "geoms", "joints", "lights", "sites",
}  # fmt: skip
# Attributes that are taken, of each kind, some of them only where a condition holds. Ranges of ball joints and lengths of tendons
# have notes of their own, and tendons add their springs.
TAKEN: dict[str, Taken] = {
    "Body": _all("pos quat ipos iquat mass inertia fullinertia explicitinertial gravcomp"),
    "Joint": _all("type pos axis range limited align ref") | {
        "springref": _has_axis, "springdamper": _has_axis, "frictionloss": _has_axis, "armature": _has_axis,
        "stiffness": _first_only("stiffness"), "damping": _first_only("damping"),
    },
    "Geom": _all(
        "type pos quat size fromto contype conaffinity density mass meshname hfieldname fitscale typeinertia rgba material friction condim"
    ),
    # Actuators that are left out have notes of their own.
    "Actuator": _all(
        "actdim actlimited actrange biasprm biastype cranklength ctrllimited ctrlrange ctrlspec dynprm dyntype forcelimited forcerange gainprm "
        "gaintype gear inheritrange lengthrange refsite slidersite target trntype type"
    ),
    "Material": _all("rgba"),
    "Equality": _all("type name1 name2 objtype data active"),
    "Tendon": _all("path limited range"),
    "Option": _all("gravity"),
}  # fmt: skip
# Kinds that MuJoCo has used up when the model is built.
BUILT = {"Default", "Exclude", "Frame", "HField", "Mesh"}
# Kinds that are counted, not named: there are many, and a user knows of them.
COUNTED = {"Camera", "Key", "Light", "Sensor", "Site", "Texture"}
ALSO_SO = {"Site": ", apart from the ends of tendons and equalities", "Key": " (keyframes)"}
# As files call them, where the model's name is another one.
IN_FILES = {
    "actfrclimited": "actuatorfrclimited", "actfrcrange": "actuatorfrcrange", "actgravcomp": "actuatorgravcomp",
    "fluid_coefs": "fluidcoef", "fluid_ellipsoid": "fluidshape", "hfieldname": "hfield", "meshname": "mesh", "textures": "texture",
}  # fmt: skip


def left_out(mujoco: Any, spec: Any, roots: Iterable[Element], is_taken: Callable[[str, int, str], bool]) -> list[str]:
    """One note for each kind of element, and each attribute of a kind, that is not taken. spec: as MuJoCo reads the file. roots: of its
    files. is_taken: of a kind, the number of an element and an attribute, beyond the table."""
    elements: dict[str, list[Any]] = {}
    for name in dir(spec):
        if name.startswith("_") or name == "copy_during_attach":
            continue
        value = getattr(spec, name)
        if isinstance(value, list):
            for each in value:
                elements.setdefault(type(each).__name__.removeprefix("Mjs"), []).append(each)
    notes = []
    usual = mujoco.MjSpec()
    for kind, found in elements.items():
        if kind in TAKEN:
            notes += _attributes(kind, found, _usual(usual, kind), is_taken)
        elif kind not in BUILT and kind in COUNTED:
            notes.append(f"{_count(len(found), kind.lower())} left out{ALSO_SO.get(kind, '')}")
        elif kind not in BUILT:
            named = _listed([_label(kind, number, each) for number, each in enumerate(found)])
            notes.append(f"{_count(len(found), kind.lower())} left out: {named}")
    lines = {
        name: each.line for root in roots for each in root.walk() if each.tag == "option" for name in each.attributes
    }
    changed = {}
    for name in _attribute_names(spec.option):
        if name in TAKEN["Option"] or name in ("disableflags", "enableflags"):
            continue
        if not _is_same(getattr(spec.option, name), getattr(usual.option, name, None)):
            where = f", line {lines[name]}" if name in lines else ""
            changed[name] = f"{name} {_shown(getattr(spec.option, name))}{where}"
    if changed:
        notes.append(f"options are left out: {_listed(list(changed.values()), 99)}")
    flags = [
        f"{bit.name.partition('_')[2].lower()} {what}"
        for bits, mask, what in (
            (mujoco.mjtDisableBit, int(spec.option.disableflags), "off"),
            (mujoco.mjtEnableBit, int(spec.option.enableflags), "on"),
        )
        for bit in map(bits, _members(bits))
        if mask & int(bit) and bit.name != "mjDSBL_GRAVITY"
    ]
    if flags:
        notes.append(f"flags of <option> are left out: {', '.join(flags)}")
    view = [tag for tag in ("visual", "statistic") if any(each.tag == tag for root in roots for each in root.walk())]
    if view:
        notes.append(f"settings of MuJoCo's view are left out: {' and '.join(f'<{tag}>' for tag in view)}")
    return notes


def gravity_note(mujoco: Any, spec: Any) -> list[str]:
    """Gravity is that of the system, which the file's structure does not set."""
    x, y, z = (float(v) for v in spec.option.gravity)
    if int(spec.option.disableflags) & int(mujoco.mjtDisableBit.mjDSBL_GRAVITY):
        x = y = z = 0.0
    usual = mujoco.MjSpec()  # kept, as MuJoCo frees what hangs on it
    if _is_same((x, y, z), tuple(float(v) for v in usual.option.gravity)):
        return []
    ours = ", ".join(f"{v + 0.0:g}" for v in (x, z, -y))
    return [f"the gravity of the file is left out, as the system has one: system.gravity = ({ours})"]


def _members(bits: Any) -> list[int]:
    """The single bits of a set of flags."""
    values = [int(getattr(bits, name)) for name in dir(bits) if name.startswith(("mjDSBL_", "mjENBL_"))]
    return sorted(values)


def _usual(spec: Any, kind: str) -> Any:
    """A new element of that kind, with default values."""
    body = spec.worldbody.add_body()
    makers = {"Body": lambda: body, "Joint": body.add_joint, "Geom": body.add_geom}
    return makers[kind]() if kind in makers else getattr(spec, f"add_{kind.lower()}")()


def _attributes(kind: str, found: list[Any], usual: Any, is_taken: Callable[[str, int, str], bool]) -> list[str]:
    other: dict[str, list[str]] = {}
    table = TAKEN[kind]
    names = [name for name in _attribute_names(usual) if name not in NO_EFFECT]
    for name in names:
        if name in table and table[name] is None:
            continue
        default = _plain(getattr(usual, name))
        for number, element in enumerate(found):
            value = getattr(element, name)
            if _plain(value) == default:
                continue
            condition = table.get(name)
            if (condition is not None and condition(element)) or is_taken(kind, number, name):
                continue
            called = IN_FILES.get(name, name.replace("_", ""))
            label = _label(kind, number, element)
            if name in ("stiffness", "damping") and isinstance(value, np.ndarray):
                value = np.trim_zeros(value, "b")
                if kind == "Joint" and _has_axis(element):
                    label += ", beyond the first coefficient,"
            other.setdefault(called, []).append(f"{label} ({_shown(value)})" if _shown(value) else label)
    return [f"{name} of {_listed(labels)} is left out" for name, labels in other.items()]


def _attribute_names(element: Any) -> list[str]:
    return [name for name in dir(element) if not name.startswith("_") and not callable(getattr(element, name))]


def _label(kind: str, number: int, element: Any) -> str:
    name = element.name or str(number)
    # MuJoCo tells no lines of included files.
    line = element.info if str(element.info).startswith("line ") and element.info != "line 0" else ""
    return f"{kind.lower()} {name}" + (f", {line}" if line else "")


def _listed(labels: list[str], most: int = MOST_NAMED) -> str:
    return "; ".join(labels[:most]) + (f"; and {len(labels) - most} more" if len(labels) > most else "")


def _count(number: int, what: str) -> str:
    if number == 1:
        return f"1 {what} is"
    return f"{number} {what[:-1] + 'ies' if what.endswith('y') else what + 's'} are"


def _shown(value: Any) -> str:
    """A number, or a few of them; nothing for all else."""
    if isinstance(value, bool | np.bool_):
        return str(bool(value)).lower()
    if isinstance(value, int | float | np.number):
        return f"{float(value):g}"
    if isinstance(value, str):
        return value
    if isinstance(value, np.ndarray) and value.size <= 6:
        return " ".join(f"{float(v):g}" for v in np.ravel(value))
    return ""


def _is_same(value: Any, usual: Any) -> bool:
    return bool(_plain(value) == _plain(usual))


def _plain(value: Any) -> Any:
    """Values that can be compared: numbers that are not numbers count as equal."""
    if isinstance(value, float | np.floating):
        return "nan" if value != value else float(value)
    if value is None or isinstance(value, bool | int | str | bytes):
        return value
    if isinstance(value, np.ndarray):
        return tuple(_plain(v) for v in np.ravel(value).tolist())
    if hasattr(value, "value") and hasattr(value, "name"):
        return int(value)
    if type(value).__name__.startswith("Mjs"):
        return None  # plugins and paths, which are elements of their own; looking into an unused one crashes MuJoCo 4.0
    try:
        return tuple(_plain(v) for v in value)
    except TypeError:
        return repr(value)
