# SPDX-License-Identifier: Apache-2.0
"""Explains in a sentence why the arguments of a call are wrong: where a call fits no signature.

The signatures come from the engine, as in the stub file, or from the functions in Python.
"""

from __future__ import annotations

import ast
import difflib
import dis
import functools
import inspect
import re
import reprlib
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from types import FunctionType, MappingProxyType, TracebackType, UnionType
from typing import Any, Literal, NoReturn, Union, get_args, get_origin, get_type_hints

from iota import _core
from iota._core import Vec3

SHORT = reprlib.Repr()
SHORT.maxother = SHORT.maxstring = 60
INSTEAD: dict[type, Mapping[str, str]] = {}  # what to use instead of attributes that classes of the engine do not have
VECTOR = ("Sequence", "NDArray")  # types accepted as a Vec3
LARGEST = 2**31
RAISE = dis.opmap["RAISE_VARARGS"]  # the statement


def of_type(value: Any, kind: type, name: str) -> Any:
    """The value, of data from a file. Raises ValueError that names it unless it is of its kind; a tuple is a list."""
    if isinstance(value, (list, tuple) if kind is list else kind) and isinstance(value, bool) == (kind is bool):
        return value
    words = {dict: "an object", list: "a list", str: "a text", int: "a whole number", bool: "true or false"}
    raise ValueError(f"{name} must be {words[kind]}, not {SHORT.repr(value)}")


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
        near = near_attribute(name, [n for n in known if is_settable(kind, n)], INSTEAD.get(kind, {}))
        return f"{a(kind.__name__)} has no attribute '{name}'{near}"
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


def refuse_unknown(thing: object, name: str, elsewhere: Mapping[str, str] = MappingProxyType({})) -> None:
    """Raises AttributeError for a public attribute that the class of a thing does not have, or that cannot be assigned.
    elsewhere: as of `refuse_reading`."""
    kind = type(thing)
    known: set[str] | None = kind.__dict__.get("_assigned")
    if known is None:
        kind._assigned = known = set()  # type: ignore[attr-defined]
    if name in known:
        return
    is_ours = kind.__module__.startswith("iota.") and name[0] != "_"
    if is_ours and not any(name in vars(each).get("__annotations__", ()) for each in kind.__mro__):
        member = inspect.getattr_static(kind, name, None)
        if member is None:
            settable = [n for n in dir(kind) if is_settable(kind, n)]
            near = near_attribute(name, settable, elsewhere)
            raise AttributeError(f"{a(kind.__name__)} has no attribute '{name}'{near}")
        if isinstance(member, property) and member.fset is None:
            raise AttributeError(f"{kind.__name__}.{name} can be read but not assigned")
        if isinstance(member, FunctionType):
            raise AttributeError(f"{kind.__name__}.{name} is a method and cannot be assigned")
    known.add(name)


def refuse_reading(thing: object, name: str, elsewhere: Mapping[str, str] = MappingProxyType({})) -> NoReturn:
    """For `__getattr__`: raises AttributeError for what a thing does not have, with a near name. elsewhere: what to use
    instead of names of its parts and of other libraries."""
    kind = type(thing)
    if inspect.getattr_static(kind, name, None) is not None:
        object.__getattribute__(thing, name)  # raises the error that came from inside of a property
    near = near_attribute(name, [n for n in dir(kind) if not n.startswith("_")], elsewhere)
    raise AttributeError(f"{a(kind.__name__)} has no attribute '{name}'{near}")


def explain_reading(kind: type, elsewhere: Mapping[str, str]) -> None:
    """Lets a class of the engine say where names are that it does not have; tracebacks add near names of its own."""
    INSTEAD[kind] = elsewhere

    def read(thing: object, name: str) -> object:
        if name in elsewhere:
            refuse_reading(thing, name, elsewhere)
        return object.__getattribute__(thing, name)  # raises

    setattr(kind, "__getattr__", read)  # noqa: B010  # checkers would take any name


def near_attribute(name: str, names: Iterable[str], elsewhere: Mapping[str, str] = MappingProxyType({})) -> str:
    """The place of an attribute, or of a near one."""
    if name in elsewhere:
        return f": it is {elsewhere[name]}"
    return "" if name[:1] == "_" else suggestion(name, list(names), elsewhere)


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
                return self.needs(argument)
        return None

    def needs(self, argument: ast.arg) -> str:
        return f"{called(self.name)} needs {argument.arg}: {in_words(argument.annotation)}"

    def result_class(self) -> type | None:
        return class_of(self.result)

    def explain_value(self, argument: ast.arg, value: Any, label: str) -> str | None:
        if fits(argument.annotation, value):
            return None
        if isinstance(value, int) and fits(argument.annotation, 0):
            return f"{label} must be {in_words(argument.annotation)} of usual size, not {SHORT.repr(value)}"
        text = f"{label} must be {in_words(argument.annotation)}, not {SHORT.repr(value)}"
        if isinstance(value, _core.Body) and class_of(argument.annotation) is _core.Particle:
            text += "; a particle of a body is made by body.attachment(place) or body.particle(place)"
        return text

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
        if (self.name, word) in ELSEWHERE:
            return f"{text}: it is {ELSEWHERE[self.name, word]}"
        result = self.result_class()
        near = suggestion(word, words)
        if not near and result and is_settable(result, word):
            return f"{text}; assign it to the result: {result.__name__.lower()}.{word} = ..."
        takes = f"t takes {', '.join(words) or 'none'}"
        return f"{text}{near} I{takes}" if near else f"{text}; i{takes}"


# --- functions and classes in Python ------------------------------------------------------------------------------------


class PythonSignature(Signature):
    """The signature of a function in Python, of which only the words and the number of arguments are judged: it checks values itself."""

    def __init__(self, name: str, function: Callable[..., Any]) -> None:
        super().__init__(name, text_of(function))
        self.globals = getattr(inspect.unwrap(function), "__globals__", {})

    def explain_value(self, argument: ast.arg, value: Any, label: str) -> None:
        return None

    def needs(self, argument: ast.arg) -> str:
        known = [
            option for option in options_of(argument.annotation) if base_name(option) in PLAIN or classes_of(option)
        ]
        of_what = f": {in_words(argument.annotation)}" if known and known == [*options_of(argument.annotation)] else ""
        return f"{called(self.name)} needs {argument.arg}{of_what}"

    def result_class(self) -> type | None:
        found = self.globals.get(base_name(self.result)) if self.result is not None else None
        return found if isinstance(found, type) else None


def text_of(function: Callable[..., Any]) -> str:
    """A signature in the form of nanobind's: defaults do not matter."""
    marks: dict[Any, str] = {inspect.Parameter.VAR_POSITIONAL: "*", inspect.Parameter.VAR_KEYWORD: "**"}
    words, star = [], False
    for parameter in inspect.signature(function).parameters.values():
        star = star or parameter.kind is parameter.VAR_POSITIONAL
        if parameter.kind is parameter.KEYWORD_ONLY and not star:
            words.append("*")
            star = True
        mark, kind = marks.get(parameter.kind, ""), parameter.annotation
        typed = f": {kind if isinstance(kind, str) else getattr(kind, '__name__', 'Any')}"
        typed = "" if kind is parameter.empty else typed
        words.append(f"{mark}{parameter.name}{typed}{'' if parameter.default is parameter.empty else ' = None'}")
    result = inspect.signature(function).return_annotation
    return f"def f({', '.join(words)})" + (f" -> {result}" if isinstance(result, str) else "")


def explaining(function: Callable[..., Any], name: str) -> Callable[..., Any]:
    """The function, which refuses arguments that do not fit in a sentence. They are looked at only after a call was
    refused. name: as of `explain_call`."""

    @functools.wraps(function)
    def call(*given: Any, **named: Any) -> Any:
        try:
            return function(*given, **named)
        except (TypeError, ValueError, AttributeError) as error:
            # One that was raised inside of the function has its frame.
            inner = None if error.__traceback__ is None else error.__traceback__.tb_next
            if inner is None:
                text = PythonSignature(name, function).explain(given, named)
            else:
                text = None if is_said(inner) else misfit(function, name, given, named)
            if text is None:
                raise
            raise TypeError(text) from None

    return call


def is_said(trace: TracebackType) -> bool:
    """Whether an error comes from a statement `raise`: then it is a sentence already, or the script's own."""
    while trace.tb_next is not None:
        trace = trace.tb_next
    return trace.tb_frame.f_code.co_code[trace.tb_lasti] == RAISE


def misfit(function: Callable[..., Any], name: str, given: Sequence[Any], named: Mapping[str, Any]) -> str | None:
    """A sentence about the first argument that is not of the type of its annotation; None without one."""
    try:
        hints = get_type_hints(function)
    except NameError:  # of types that only checkers import
        return None
    signature = inspect.signature(function)
    for word, value in signature.bind(*given, **named).arguments.items():
        kind = signature.parameters[word].kind
        if word not in hints or kind in (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD):
            continue
        if not is_of(hints[word], value):
            return f"{called(name)}: {word} must be {hint_in_words(hints[word])}, not {SHORT.repr(value)}"
    return None


def is_of(hint: Any, value: Any) -> bool:
    """Whether a value is of an annotated type, as far as that can be told; what cannot counts."""
    origin, parts = get_origin(hint), get_args(hint)
    if hint is Any:
        return True
    if origin in (Union, UnionType):
        return any(is_of(part, value) for part in parts)
    if origin is Literal:
        return value in parts
    if hint is None or hint is type(None):
        return value is None
    if hint is float:
        return is_number(value)
    if hint is int:
        return hasattr(type(value), "__index__")
    if origin is Callable:
        return callable(value)
    if origin in (Sequence, Iterable) and parts == (float,):
        return isinstance(value, Iterable) and not isinstance(value, str | bytes) and all(map(is_number, value))
    if origin is Iterable:
        return isinstance(value, Iterable)
    if isinstance(origin, type):
        return isinstance(value, origin)
    return isinstance(value, hint) if isinstance(hint, type) else True


WORDS = {
    float: "a number",
    int: "a whole number",
    str: "a text",
    bool: "True or False",
    bytes: "bytes",
    type(None): "None",
}


def hint_in_words(hint: Any) -> str:
    origin, parts = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        return one_of(
            dict.fromkeys(hint_in_words(part) for part in parts if Vec3 not in parts or part != Sequence[float])
        )
    if origin is Literal:
        return f"one of {', '.join(map(repr, parts))}"
    if origin in (Sequence, Iterable):
        return "numbers" if parts == (float,) else "a list"
    if origin is Callable:
        return "a function"
    kind = origin or hint
    if kind is Vec3:
        return "2 or 3 numbers"
    return WORDS.get(kind) or a(getattr(kind, "__name__", str(kind)))


def explain(*types: type) -> None:
    """Lets all public functions of classes, and of those that they inherit, explain their arguments."""
    own_kinds = (each for kind in types for each in kind.__mro__ if each.__module__.startswith("iota."))
    for kind in dict.fromkeys(own_kinds):
        for name, member in list(vars(kind).items()):
            own = f"{kind.__name__}.{name}"
            if (name != "__init__" and name.startswith("_")) or hasattr(member, "__wrapped__"):
                continue
            if isinstance(member, FunctionType):
                setattr(kind, name, explaining(member, own))
            elif isinstance(member, classmethod):
                setattr(kind, name, classmethod(explaining(member.__func__, own)))


def explain_module(name: str) -> None:
    """Lets the public functions and classes of a module, those in its `__all__` or its own, explain their arguments."""
    module = sys.modules[name]
    own = [word for word, each in vars(module).items() if word[0] != "_" and getattr(each, "__module__", "") == name]
    for public in getattr(module, "__all__", own):
        found = getattr(module, public)
        if isinstance(found, FunctionType) and not hasattr(found, "__wrapped__"):
            setattr(module, public, explaining(found, public))
        elif isinstance(found, type) and found.__module__.startswith("iota.") and not issubclass(found, BaseException):
            explain(found)


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
    member = inspect.getattr_static(kind, name, None)
    if name.startswith("_") or member is None:
        return False
    return member.fset is not None if isinstance(member, property) else hasattr(type(member), "__set__")


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


# For functions and arguments that they do not have, what to use instead.
ELSEWHERE = {
    ("World.__init__", "gravity"): "that of the system, as in iota.System(gravity=(0, -9.81, 0))",
    ("System.__init__", "dt"): "that of the world, iota.World(system, dt=...), or of system.step(dt)",
    ("Scene.draw", "color"): "body.color = ..., or that of the look",
    ("System.body", "friction"): "material=iota.Material(friction=...)",
    ("System.body", "restitution"): "material=iota.Material(restitution=...)",
    ("System.body", "size"): "shape=iota.Box(size)",
    ("System.body", "radius"): "shape=iota.Sphere(radius)",
    ("System.obstacle", "friction"): "material=iota.Material(friction=...)",
}
# For each argument of ours, its names in other libraries.
NEAR = 0.64  # of a misspelled word: less is another one, as "gravity" and "ray"
MEANT = {
    "restitution": ("bounce", "bounciness", "elasticity"),
    "friction": ("mu", "static_friction"),
    "position": ("eye", "location", "place", "center", "centre", "origin", "xyz", "translation"),
    "at": ("position", "eye", "location", "place", "center", "centre", "origin", "xyz"),
    "target": ("look_at", "lookat", "focus", "aim", "to", "center", "centre"),
    "rotation": ("orientation", "quaternion", "quat", "angle", "euler"),
    "orientation": ("rotation", "quaternion", "quat", "angle", "euler"),
    "text": ("label", "title", "name", "caption", "string", "message"),
    "label": ("text", "title", "name", "caption"),
    "title": ("text", "label", "name", "caption"),
    "value": ("initial", "default", "start"),
    "color": ("paint", "fill", "rgb"),
    "size": ("dimensions", "extents", "half_extents", "scale"),
    "stiffness": ("k", "spring"),
    "minimum": ("start", "low", "lower", "lowest"),
    "maximum": ("stop", "end", "high", "upper", "highest"),
}


def suggestion(word: str, words: Sequence[str], elsewhere: Mapping[str, str] = MappingProxyType({})) -> str:
    """For a misspelled word, another library's, or the beginning of one. elsewhere: more words, and where they are."""
    words = [*words, *elsewhere]
    near = [
        meant for meant, others in MEANT.items() if meant in words and difflib.get_close_matches(word, others, 1, 0.8)
    ]
    near = difflib.get_close_matches(word, words, 1, 0.8) + near + difflib.get_close_matches(word, words, 1, NEAR)
    near += [each for each in words if len(word) > 2 and each.startswith(word)]
    return f"; did you mean '{elsewhere.get(near[0], near[0])}'?" if near else ""
