"""Names, signatures, docstrings, and what is in the wheel. Checks PYT-001, PYT-009, PYT-051."""

import ast
import doctest
import importlib.metadata
import inspect
import re
from pathlib import Path

import docstring_parser
import numpy as np
import palpate

STUBS = Path(palpate.__file__).with_name("__init__.pyi")


def public(owner):
    return {name: getattr(owner, name) for name in dir(owner) if not name.startswith("_")}


def parameters(function):
    found = inspect.signature(function).parameters
    return [(p.name, p.default is not p.empty) for p in found.values() if p.kind is not p.VAR_KEYWORD]


def stubbed(node):
    names = [argument.arg for argument in node.args.posonlyargs + node.args.args]
    first = len(names) - len(node.args.defaults)
    return [(name, at >= first) for at, name in enumerate(names)]


def test_the_stubs_have_the_names_and_signatures_of_the_module():
    tree = ast.parse(STUBS.read_text())
    defined = {node.name: node for node in tree.body if hasattr(node, "name") and not node.name.startswith("_")}
    module = {name: value for name, value in public(palpate).items() if not inspect.ismodule(value)}
    assert set(defined) | {"build"} == set(module)
    for name, node in defined.items():
        if isinstance(node, ast.FunctionDef):
            assert stubbed(node) == parameters(module[name]), name
            continue
        methods = {inner.name: inner for inner in node.body if isinstance(inner, ast.FunctionDef)}
        plain = {inner for inner in methods if not inner.startswith("__")}
        members = set(public(module[name])) - set(public(ValueError)) if name == "Refused" else set(public(module[name]))
        assert plain == members, name
        for inner in plain:
            if not any(getattr(mark, "id", "") == "property" for mark in methods[inner].decorator_list):
                assert stubbed(methods[inner]) == parameters(getattr(module[name], inner)), (name, inner)
        if "__new__" in methods:
            assert stubbed(methods["__new__"])[1:] == parameters(module[name]), name


def documented():
    for name, value in public(palpate).items():
        if inspect.isclass(value) or callable(value):
            yield name, value
        if inspect.isclass(value) and value is not palpate.Refused:
            for inner, member in public(value).items():
                yield f"{name}.{inner}", member


def test_every_name_says_what_it_is_with_shape_and_unit():
    no_unit = {
        # Texts, phantoms, maps and errors: no numbers.
        "Refused", "Phantom.from_toml", "Phantom.name", "ForceMap.read", "ForceMap.from_json", "Bank.from_json", "ForceMap.phantom", "Bank", "Bank.read", "Bank.write",
        "Bank.reference", "Bank.maps", "ServoState", "ServoState.mode", "ServoState.fault", "ServoState.missed",
        # Ratios and probabilities.
        "Statistic", "Statistic.theta", "Statistic.gamma", "MatchedFilter.gamma", "ask",
    }
    units = r"\b(mm|kPa|N|N/m|Pa|SI|m|unit|units|newtons)\b|no unit|\bPr\(|\brates?\b|share|whether|eta|area|gamma"
    count = 0
    for name, value in documented():
        text = value.__doc__
        assert text and len(text) > 10, name
        assert name in no_unit or re.search(units, text, re.IGNORECASE), name
        assert "Implements" not in text, name
        count += 1
    assert count > 70


def test_every_parameter_and_answer_has_a_line_that_numpydoc_reads():
    count = 0
    for name, value in documented():
        if not callable(value) or value is palpate.Refused:
            continue
        expected = [parameter for parameter in inspect.signature(value).parameters.values() if parameter.name != "self"]
        text = docstring_parser.parse(value.__doc__, docstring_parser.DocstringStyle.NUMPYDOC)
        told = {of.arg_name: of for of in text.params}
        assert [of.lstrip("*") for of in told] == [parameter.name for parameter in expected], name
        for parameter in expected:
            of = [of for key, of in told.items() if key.lstrip("*") == parameter.name][0]
            assert of.description and "\n" not in of.description and of.type_name, (name, parameter)
            is_optional = parameter.default is not parameter.empty
            assert is_optional == bool(of.is_optional), (name, parameter)
            # A name that has a unit says so.
            unit = re.search("_(mm|n|kpa|s)$", parameter.name)
            if unit:
                assert re.search({"mm": r"\bmm\b", "n": r"\bN\b", "kpa": r"\bkPa\b", "s": r"\bs\b"}[unit[1]], of.description), (name, parameter)
        returns = text.returns and text.returns.type_name and text.returns.description
        assert bool(returns) == (bool(expected) and not inspect.isclass(value) and not name.endswith((".write", ".write_vtu"))), name
        assert {of.type_name for of in text.raises} <= {"Refused"}, name
        count += len(expected)
    assert count > 150


def test_the_examples_of_docstrings_print_what_they_show():
    names = {name: getattr(palpate, name) for name in public(palpate)}
    examples = 0
    for name, value in documented():
        [test] = [doctest.DocTestParser().get_doctest(value.__doc__, {**names, "np": np}, name, None, 0)]
        examples += len(test.examples)
        assert doctest.DocTestRunner().run(test).failed == 0, name
    assert examples > 15


def test_every_function_of_arrays_says_their_shape():
    count = 0
    for owner in ast.walk(ast.parse(STUBS.read_text())):
        for node in [inner for inner in getattr(owner, "body", []) if isinstance(inner, ast.FunctionDef)]:
            takes_arrays = any(ast.unparse(a.annotation or a).startswith("ArrayLike") for a in node.args.args)
            holder = palpate if isinstance(owner, ast.Module) else getattr(palpate, owner.name)
            of = holder if node.name == "__new__" else getattr(holder, node.name)
            if takes_arrays:
                assert re.search(r"shape|arrays", of.__doc__, re.IGNORECASE), node.name
                count += 1
    assert count > 25


def test_one_wheel_for_all_pythons():
    wheel = importlib.metadata.distribution("palpate").read_text("WHEEL")
    assert "Tag: cp310-abi3-" in wheel
    assert importlib.metadata.version("palpate") == palpate.__version__ == palpate.build["version"]
    assert STUBS.with_name("py.typed").exists()
