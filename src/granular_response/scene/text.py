"""YAML in and out: safe, no repeated keys, and numbers read as YAML 1.2 reads them.

PyYAML follows YAML 1.1, where ``1e-13`` is a string, ``010`` is eight and ``no`` is false. The reader here
knows only the types a scene can hold: null, true and false, whole numbers, numbers, text, lists, mappings.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, ClassVar

import yaml

from .errors import SceneError, show

_TAG = "tag:yaml.org,2002:"
_NUMBER = r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)"
#: Of each type of a value: how it is spelled, how that may begin, and the value.
_SCALARS: dict[str, tuple[re.Pattern[str], list[str], Callable[[str], Any]]] = {
    f"{_TAG}null": (re.compile(r"(?:~|null|Null|NULL|)$"), ["~", "n", "N", ""], lambda _: None),
    f"{_TAG}bool": (
        re.compile(r"(?:true|True|TRUE|false|False|FALSE)$"), list("tTfF"), lambda text: text.lower() == "true",
    ),
    f"{_TAG}int": (re.compile(r"[-+]?[0-9]+$"), list("-+0123456789"), int),
    f"{_TAG}float": (
        re.compile(f"(?:{_NUMBER})$"), list("-+.0123456789"),
        lambda text: float(text.lower().replace(".inf", "inf").replace(".nan", "nan")),
    ),
}  # fmt: skip


class _Reader(yaml.SafeLoader):
    yaml_implicit_resolvers: ClassVar[dict] = {}
    yaml_constructors: ClassVar[dict] = {}

    def _mapping(self, node: yaml.MappingNode) -> dict:
        if not isinstance(node, yaml.MappingNode):
            raise _mistake(node, "must be a mapping, as its tag says")
        result: dict = {}
        for key_node, value_node in node.value:
            key = self.construct_object(key_node, deep=True)
            try:
                known = key in result
            except TypeError:
                raise _mistake(key_node, "a key must be text") from None
            if known:
                raise _mistake(key_node, f"key {show(key)} is given twice")
            result[key] = self.construct_object(value_node, deep=True)
        return result

    def _list(self, node: yaml.SequenceNode) -> list:
        return self.construct_sequence(node, deep=True)

    def _scalar(self, node: yaml.ScalarNode) -> Any:
        text = str(self.construct_scalar(node))
        if node.tag not in _SCALARS:
            return text
        pattern, _, value_of = _SCALARS[node.tag]
        if not pattern.match(text):
            raise _mistake(node, f"{show(text)} does not fit its tag")
        try:
            return value_of(text)
        except ValueError:
            raise _mistake(node, f"number {show(text)} is too long") from None

    def _unknown(self, node: yaml.Node) -> Any:
        raise _mistake(node, f"tag {show(node.tag)} is not allowed")


class _Dumper(yaml.SafeDumper):
    """Writes text in quotes wherever either version of YAML would take it for something else."""

    def ignore_aliases(self, data: Any) -> bool:
        return True


for _tag, (_pattern, _first, _) in _SCALARS.items():
    _Reader.add_implicit_resolver(_tag, _pattern, _first)
    _Dumper.add_implicit_resolver(_tag, _pattern, _first)
    _Reader.add_constructor(_tag, _Reader._scalar)
_Reader.add_constructor(f"{_TAG}str", _Reader._scalar)
_Reader.add_constructor(f"{_TAG}seq", _Reader._list)
_Reader.add_constructor(f"{_TAG}map", _Reader._mapping)
_Reader.add_constructor(None, _Reader._unknown)


def _mistake(node: yaml.Node, problem: str) -> yaml.MarkedYAMLError:
    return yaml.constructor.ConstructorError(problem=problem, problem_mark=node.start_mark)


def read(text: str) -> Any:
    """The content of one YAML document; SceneError, with line and column, for what is not one of plain data."""
    try:
        return yaml.load(text, _Reader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
        raise SceneError(f"{where}not valid YAML: {error.problem or error.context}") from None
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise SceneError(f"line {line}: not valid YAML: {error.reason}") from None
    except RecursionError:
        raise SceneError("not a scene: lists or mappings are nested too deeply") from None


def write(data: Any) -> str:
    """``data`` as YAML that ``read`` turns into equal data; numbers keep every digit."""
    return yaml.dump(data, Dumper=_Dumper, sort_keys=False, default_flow_style=None, allow_unicode=True, width=110)
