# SPDX-License-Identifier: Apache-2.0
"""Explains in a sentence why the arguments of a call are wrong; the engine calls it when a call fits no signature.

The signatures come from the engine, as in the stub file.
"""

from __future__ import annotations

import ast
import difflib
import re
import reprlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, get_args

from iota import _core

SHORT = reprlib.Repr()
SHORT.maxother = SHORT.maxstring = 60
VECTOR = ("Sequence", "NDArray")  # types accepted as a Vec3
LARGEST = 2**31


def explain_call(
    name: str, signatures: Sequence[tuple[Any, ...]], given: Sequence[Any], named: Mapping[str, Any]
) -> str:
    """Why none of the signatures takes these arguments.

    name: 'Body.particle', 'Body.__init__', 'Body.damping = ...' for an assignment. signatures: as nanobind prints them.
    given, named: the arguments, including `self`.
    """
    texts = []
    for text, documentation, *_ in signatures:
        try:
            texts.append(Signature(name, str(text), str(documentation or "")).explain(given, named))
        except SyntaxError:
            continue  # nanobind's signatures are not always valid Python
    return next(
        (text for text in texts if text), f"{called(name)} cannot take these arguments: see help({called(name)})"
    )


def explain_making(kind: type) -> str:
    """Why a type cannot be called; its documentation names the function that makes it."""
    _, found, rest = (kind.__doc__ or "").partition("made by ")
    if not found:
        return f"a script cannot make {a(kind.__name__)}: it comes from reports of the engine"
    maker = re.split(r"[.;:](?:\s|$)", rest)[0].replace("`", "").rstrip(". ")
    return f"{kind.__name__} cannot be called: {a(kind.__name__)} is made by {maker}"


def explain_assignment(kind: type, name: str) -> str | None:
    """Why an attribute cannot be assigned; None if it can, so that the assigned value is wrong."""
    known = [n for n in dir(kind) if not n.startswith("_")]
    member = getattr(kind, name, None)
    if name not in known:
        return f"{a(kind.__name__)} has no attribute '{name}'{suggestion(name, [n for n in known if is_settable(kind, n)])}"
    if not isinstance(member, property):
        return f"{kind.__name__}.{name} is a method and cannot be assigned"
    if member.fset is not None:
        return None
    result = result_of(member.fget)
    parts = [n for n in dir(result) if is_settable(result, n)] if result else []
    instead = (
        f": it is {a(result.__name__)}; assign {one_of(f'.{name}.{n}' for n in parts)}" if result and parts else ""
    )
    return f"{kind.__name__}.{name} can be read but not assigned{instead}"


class Signature:
    """One signature of a function."""

    def __init__(self, name: str, text: str, documentation: str = "") -> None:
        """text: 'def particle(self, position: Vec3 = \\0) -> Particle'; defaults are numbers, and setters have no
        name."""
        self.name, self.documentation = name, documentation
        text = re.sub(r"ndarray\[[^\]]*\]", "ArrayLike", text.replace("def (", "def f("))
        function = ast.parse(re.sub(r"= \\\d+", "= None", text) + ": ...").body[0]
        assert isinstance(function, ast.FunctionDef)
        self.result = function.returns
        arguments = function.args
        self.positional = [*arguments.posonlyargs, *arguments.args]
        self.keywords = arguments.kwonlyargs
        self.unnamed = {argument.arg for argument in arguments.posonlyargs}
        self.optional = {argument.arg for argument in self.positional[len(self.positional) - len(arguments.defaults) :]}
        self.optional |= {
            argument.arg
            for argument, default in zip(self.keywords, arguments.kw_defaults, strict=True)
            if default is not None
        }
        self.takes_more, self.takes_any_keyword = arguments.vararg is not None, arguments.kwarg is not None
        self.is_method = bool(self.positional) and self.positional[0].arg == "self"

    def explain(self, given: Sequence[Any], named: Mapping[str, Any]) -> str | None:
        if self.name.endswith(" = ..."):
            text = self.explain_value(self.positional[-1], given[-1], self.name.removesuffix(" = ...").split(".")[-1])
            is_tuple = any(base_name(option) == "tuple" for option in options_of(self.positional[-1].annotation))
            return f"{text}: {self.documentation}" if text and is_tuple else text
        positional = self.positional
        if self.is_method:
            of = self.name.split(".")[0]
            if not given or not (given[0] is None or isinstance(given[0], getattr(_core, of, object))):
                return f"{self.name} is a method of {a(of)}: call it as {of.lower()}.{self.name.split('.')[-1]}(...)"
            positional, given = positional[1:], given[1:]
        words = [argument.arg for argument in [*positional, *self.keywords]]
        if len(given) > len(positional) and not self.takes_more:
            return self.too_many(positional, len(given))
        places = {argument.arg: value for argument, value in zip(positional, given, strict=False)}
        for word in named:
            if word in places:
                return f"{called(self.name)} got '{word}' twice: at its place and by its name"
            if (word not in words or word in self.unnamed) and not self.takes_any_keyword:
                return self.unknown(word, words)
        places.update(named)
        for argument in [*positional, *self.keywords]:
            if argument.arg in places:
                value = places[argument.arg]
                if text := self.explain_value(argument, value, f"{called(self.name)}: {argument.arg}"):
                    return text + self.place_for(
                        value, [other for other in [*positional, *self.keywords] if other.arg not in places]
                    )
            elif argument.arg not in self.optional:
                return f"{called(self.name)} needs {argument.arg}: {in_words(argument.annotation)}"
        return None

    def explain_value(self, argument: ast.arg, value: Any, label: str) -> str | None:
        if fits(argument.annotation, value):
            return None
        if isinstance(value, int) and fits(argument.annotation, 0):
            return f"{label} must be {in_words(argument.annotation)} of usual size, not {SHORT.repr(value)}"
        return f"{label} must be {in_words(argument.annotation)}, not {SHORT.repr(value)}"

    def place_for(self, value: Any, free: Sequence[ast.arg]) -> str:
        """The only free argument that takes objects of this class."""
        takes = [
            argument.arg
            for argument in free
            if any(isinstance(value, classes_of(option)) for option in options_of(argument.annotation))
        ]
        return f"; did you mean {takes[0]}=...?" if len(takes) == 1 else ""

    def too_many(self, positional: Sequence[ast.arg], count: int) -> str:
        takes = ", ".join(argument.arg for argument in positional)
        text = f"{called(self.name)} takes {number_of(len(positional))}{f' ({takes})' if takes else ''}, not {count}"
        if self.keywords:
            text += f"; by name also {', '.join(argument.arg for argument in self.keywords)}"
        return text

    def unknown(self, word: str, words: Sequence[str]) -> str:
        text = f"{called(self.name)} has no argument '{word}'"
        result = class_of(self.result)
        near = suggestion(word, words)
        if not near and result and is_settable(result, word):
            return f"{text}; assign it to the result: {result.__name__.lower()}.{word} = ..."
        takes = f"t takes {', '.join(words) or 'none'}"
        return f"{text}{near} I{takes}" if near else f"{text}; i{takes}"


# --- annotations --------------------------------------------------------------------------------------------------------


def options_of(annotation: ast.expr | None) -> Iterator[ast.expr]:
    """The parts of 'A | B | C'."""
    if isinstance(annotation, ast.BinOp):
        yield from options_of(annotation.left)
        yield from options_of(annotation.right)
    elif annotation is not None:
        yield annotation


def base_name(annotation: ast.expr) -> str:
    """'Sequence' of 'collections.abc.Sequence[float]'."""
    if isinstance(annotation, ast.Subscript):
        annotation = annotation.value
    if isinstance(annotation, ast.Attribute):
        return annotation.attr
    return annotation.id if isinstance(annotation, ast.Name) else "None"


def parts_of(annotation: ast.expr) -> list[ast.expr]:
    """[float, float] of 'tuple[float, float]'."""
    if not isinstance(annotation, ast.Subscript):
        return []
    return list(annotation.slice.elts) if isinstance(annotation.slice, ast.Tuple) else [annotation.slice]


def classes_of(annotation: ast.expr | None) -> tuple[type, ...]:
    """Box, Sphere, ... of 'Shape'."""
    found = getattr(_core, base_name(annotation), None) if annotation is not None else None
    return (found,) if isinstance(found, type) else get_args(found)


def class_of(annotation: ast.expr | None) -> type | None:
    found = classes_of(annotation)
    return found[0] if len(found) == 1 else None


def result_of(function: Any) -> type | None:
    return class_of(Signature("", str(function.__nb_signature__[0][0])).result)


def is_settable(kind: type, name: str) -> bool:
    member = getattr(kind, name, None)
    return not name.startswith("_") and isinstance(member, property) and member.fset is not None


def fits(annotation: ast.expr | None, value: Any) -> bool:
    """Whether the engine takes a value for an annotation, judged by its type."""
    options = list(options_of(annotation))
    return not options or any(fits_one(option, value) for option in options)


def fits_one(option: ast.expr, value: Any) -> bool:
    name = base_name(option)
    if name == "None":
        return value is None
    if name in ("object", "Any"):
        return True
    if name == "bool":
        return isinstance(value, bool)
    if name in ("str", "Literal"):
        return isinstance(value, str)
    if name == "bytes":
        return isinstance(value, bytes)
    if name == "int":
        return hasattr(type(value), "__index__") and -LARGEST <= int(value) < LARGEST
    if name == "float":
        return is_number(value)
    if name == "tuple":
        parts = parts_of(option)
        if isinstance(value, str | bytes) or not isinstance(value, Sequence) or len(value) != len(parts):
            return False
        return all(fits(part, item) for part, item in zip(parts, value, strict=True))
    if name in ("list", "Iterable"):
        return isinstance(value, Iterable)
    if kinds := classes_of(option):
        return isinstance(value, kinds) or (name == "Vec3" and value is not None)
    return value is not None


def is_number(value: Any) -> bool:
    try:
        return not isinstance(value, str | bytes) and float(value) is not None
    except (TypeError, ValueError, OverflowError):
        return False


PLAIN = {
    "float": "a number",
    "int": "a whole number",
    "bool": "True or False",
    "str": "a text",
    "bytes": "bytes",
    "None": "None",
    "Vec3": "2 or 3 numbers",
    "Callable": "a function",
    "ArrayLike": "an array of numbers",
    "NDArray": "an array of numbers",
    "Annotated": "an array of numbers",
    "Mapping": "a dict",
    "Sequence": "a sequence",
    "Iterable": "a sequence",
    "list": "a list",
}


def in_words(annotation: ast.expr | None) -> str:
    options = list(options_of(annotation))
    if any(base_name(option) == "Vec3" for option in options):
        options = [option for option in options if base_name(option) not in VECTOR]
    return " or ".join(dict.fromkeys(map(option_in_words, options))) or "something else"


def option_in_words(option: ast.expr) -> str:
    name = base_name(option)
    if name == "Literal":
        return f"one of {', '.join(ast.unparse(part) for part in parts_of(option))}"
    if name == "tuple":
        parts = {ast.unparse(part) for part in parts_of(option)}
        if parts <= {"float", "int"}:
            return f"{len(parts_of(option))} numbers"
        return f"a tuple of {', '.join(in_words(part) for part in parts_of(option))}"
    return PLAIN[name] if name in PLAIN else a(name)


# --- words --------------------------------------------------------------------------------------------------------------


def called(name: str) -> str:
    """The name in a script: 'Box' for 'Box.__init__', 'particle' for 'Body.particle'."""
    return name.removesuffix(".__init__").split(".")[-1]


def a(noun: str) -> str:
    return f"{'an' if noun[:1] in 'AEIO' else 'a'} {noun}"


def number_of(count: int) -> str:
    return "no arguments by place" if count == 0 else f"{count} argument{'' if count == 1 else 's'} by place"


def one_of(words: Iterable[str]) -> str:
    *most, last = words
    return f"{', '.join(most)} or {last}" if most else last


def suggestion(word: str, words: Sequence[str]) -> str:
    near = difflib.get_close_matches(word, words, n=1)
    return f"; did you mean '{near[0]}'?" if near else ""
