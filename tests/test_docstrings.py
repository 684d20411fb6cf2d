"""Docstrings of the public functions and classes: complete, true to the signature, with an example."""

import ast
import dataclasses
import doctest
import enum
import importlib
import inspect
import re
import textwrap

PACKAGES = (
    "contact",
    "figures",
    "geometry",
    "image",
    "loading",
    "published",
    "report",
    "simulate",
    "simulator",
    "uncertainty",
)


def public_objects():
    """Return functions and classes by name."""
    modules = [importlib.import_module(f"fingerpad.{package}") for package in PACKAGES]
    named = {f"{one.__name__}.{name}": getattr(one, name) for one in modules for name in one.__all__}
    return {name: each for name, each in named.items() if is_documented(each)}


def is_documented(each) -> bool:
    kind = inspect.isfunction(each) or (inspect.isclass(each) and not issubclass(each, Exception))
    return kind and each.__module__.startswith("fingerpad")


def public_methods(each):
    functions = {key: getattr(member, "__func__", member) for key, member in vars(each).items()}
    return {key: one for key, one in functions.items() if inspect.isfunction(one) and not key.startswith("_")}


def results(objects) -> set[type]:
    """Return the classes that functions return, and those that these hold: users do not construct them."""
    classes = {each.__name__: each for each in objects.values() if inspect.isclass(each)}

    def named(*annotations) -> set[type]:
        words = re.findall(r"\w+", " ".join(map(inspect.formatannotation, annotations)))
        return {classes[word] for word in words if dataclasses.is_dataclass(classes.get(word))}

    functions = [each for each in objects.values() if inspect.isfunction(each)]
    found, left = set(), named(*(inspect.signature(each).return_annotation for each in functions))
    while left - found:
        found |= left
        properties = [one.fget for each in left for one in vars(each).values() if isinstance(one, property)]
        left = named(
            *(hint for each in left for hint in inspect.get_annotations(each).values()),
            *(inspect.signature(one).return_annotation for one in properties),
        )
    return found


OBJECTS = public_objects()
RESULTS = results(OBJECTS)
METHODS = {
    f"{name}.{key}": method
    for name, each in OBJECTS.items()
    if inspect.isclass(each) and each not in RESULTS
    for key, method in public_methods(each).items()
}
FUNCTIONS = {name: each for name, each in OBJECTS.items() if not inspect.isclass(each)} | METHODS


def sections(each) -> dict[str, str]:
    parts = re.split(r"^(\w[\w ]*)\n-{3,}\n", inspect.getdoc(each) or "", flags=re.MULTILINE)
    return dict(zip(["", *parts[1::2]], parts[::2], strict=True))


def documented(each) -> set[str]:
    text = sections(each).get("Parameters", "") + "\n" + sections(each).get("Attributes", "")
    lines = re.findall(r"^([*\w].*?)(?: : .*)?$", text, flags=re.MULTILINE)
    return {name.strip(" *") for line in lines for name in line.split(",")}


def arguments(each) -> set[str]:
    if inspect.isclass(each) and issubclass(each, enum.Enum):
        return set()
    if inspect.isclass(each) and issubclass(each, dict):  # a TypedDict
        return set(each.__annotations__)
    names = inspect.signature(each).parameters
    return {name for name in names if name not in {"self", "cls"} and not name.startswith("_")}


def raised(function) -> set[str]:
    tree = ast.parse(textwrap.dedent(inspect.getsource(inspect.unwrap(function))))
    errors = [node.exc for node in ast.walk(tree) if isinstance(node, ast.Raise)]
    return {error.func.id for error in errors if isinstance(error, ast.Call)}


def test_public_objects_found() -> None:
    assert len(OBJECTS) > 150
    assert len(METHODS) > 25


def test_all_arguments_are_described_and_no_others() -> None:
    missing = {name: arguments(each) - documented(each) for name, each in (OBJECTS | METHODS).items()}
    unknown = {name: documented(each) - arguments(each) for name, each in FUNCTIONS.items()}
    assert {name: names for name, names in missing.items() if names} == {}
    assert {name: names for name, names in unknown.items() if names} == {}


def test_returned_values_are_described() -> None:
    returning = {
        name: each
        for name, each in FUNCTIONS.items()
        if inspect.signature(each).return_annotation not in {None, "None"}
    }
    assert [name for name, each in returning.items() if not {"Returns", "Yields"} & set(sections(each))] == []


def test_errors_are_described() -> None:
    missing = {
        name: [error for error in raised(each) if error not in sections(each).get("Raises", "")]
        for name, each in FUNCTIONS.items()
    }
    assert {name: errors for name, errors in missing.items() if errors} == {}


def test_examples_show_a_value() -> None:
    parse = doctest.DocTestParser().get_examples
    taught = {name: each for name, each in OBJECTS.items() if each not in RESULTS}
    shown = {name: parse(sections(each).get("Examples", "")) for name, each in taught.items()}
    assert [name for name, examples in shown.items() if not any(one.want for one in examples)] == []
