"""Docstrings of what the reference lists: complete, true to the signature, with an example."""

import ast
import dataclasses
import enum
import inspect
import pkgutil
import re
import textwrap
from pathlib import Path

from numpydoc.docscrape import NumpyDocString, get_doc_object
from numpydoc.validate import validate

REFERENCE = Path(__file__).parents[1] / "docs" / "reference" / "api.md"
# Of the rules of numpydoc those of what must be there: arguments and no others, what is returned or yielded.
RULES = {"GL08", "PR01", "PR02", "RT01", "YD01"}


def public_objects() -> dict[str, object]:
    """Whatever the reference lists; what else a module holds needs a summary alone."""
    named = {}
    for line in REFERENCE.read_text(encoding="utf-8").splitlines():
        if line.startswith(".. currentmodule::"):
            module = line.split()[-1]
        elif re.fullmatch(r"   [\w.]+", line):
            name = line.strip() if "." in line else f"{module}.{line.strip()}"
            named[name] = pkgutil.resolve_name(name)
    return {name: each for name, each in named.items() if callable(each) and not is_exception(each)}


def is_exception(each) -> bool:
    return inspect.isclass(each) and issubclass(each, Exception)


def is_record(each) -> bool:
    """Whether a class is described by its attributes: they, not the arguments, are what users read."""
    kinds = enum.Enum, dict, tuple
    return inspect.isclass(each) and (issubclass(each, kinds) or dataclasses.is_dataclass(each))


def public_methods(each) -> dict[str, object]:
    functions = {key: getattr(member, "__func__", member) for key, member in vars(each).items()}
    return {key: one for key, one in functions.items() if inspect.isfunction(one) and not key.startswith("_")}


OBJECTS = public_objects()
RECORDS = {name: each for name, each in OBJECTS.items() if is_record(each)}
# A class with an example is one that users make themselves; of results, PhotographFit has one too.
METHODS = {
    f"{name}.{key}": method
    for name, each in OBJECTS.items()
    if inspect.isclass(each) and "Examples\n---" in inspect.getdoc(each) and each.__name__ != "PhotographFit"
    for key, method in public_methods(each).items()
}
FUNCTIONS = {name: each for name, each in OBJECTS.items() if not inspect.isclass(each)} | METHODS


def sections(each) -> NumpyDocString:
    return NumpyDocString(inspect.getdoc(each))


def names_in(each, *titles: str) -> set[str]:
    return {
        one.strip() for title in titles for entry in sections(each)[title] for one in entry.name.split(",")
    }


def raised(function) -> set[str]:
    tree = ast.parse(textwrap.dedent(inspect.getsource(inspect.unwrap(function))))
    errors = [node.exc for node in ast.walk(tree) if isinstance(node, ast.Raise)]
    return {error.func.id for error in errors if isinstance(error, ast.Call)}


def test_arguments_and_returned_values_are_described() -> None:
    assert len(FUNCTIONS) > 100
    # By the objects themselves: a function may have the name of its module.
    checked = {name: each for name, each in (OBJECTS | FUNCTIONS).items() if name not in RECORDS}
    found = {
        name: [error for error in validate(get_doc_object(each))["errors"] if error[0] in RULES]
        for name, each in checked.items()
    }
    assert {name: errors for name, errors in found.items() if errors} == {}


def test_records_describe_what_they_hold() -> None:
    assert len(RECORDS) > 50
    missing = {}
    for name, each in RECORDS.items():
        held = {key for key in inspect.get_annotations(each) if not key.startswith("_")}
        missing[name] = held - names_in(each, "Parameters", "Attributes")
    assert {name: keys for name, keys in missing.items() if keys} == {}


def test_errors_are_described() -> None:
    missing = {
        name: {error for error in raised(each) if error not in str(sections(each)["Raises"])}
        for name, each in FUNCTIONS.items()
    }
    assert {name: errors for name, errors in missing.items() if errors} == {}
