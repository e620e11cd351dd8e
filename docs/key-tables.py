#!/usr/bin/env python3
"""Writes docs/file-keys.md from the JSON Schemas that `wirebench info --schema` prints.

Usage: key-tables.py PAGE SCHEMA...           writes the page
       key-tables.py --check PAGE SCHEMA...   exit code 1, and the first differences, where it differs
"""

import difflib
import json
import re
import sys

INTRODUCTION = """\
# Keys of the files that wirebench writes

[File formats](file-formats.md) explains these files; this page lists every key. It is generated from the tables of keys
in `analysis/`, as are the JSON Schemas (draft 2020-12) in `share/wirebench/schemas/`, which
`wirebench info --schema dataset`, `report`, `manifest`, `properties`, `harness` or `harness-answer` prints, too. The
schemas reject unknown keys. A program that is to read files of later versions should ignore unknown keys instead,
because later versions add keys ([versions](versions.md#what-a-version-number-promises)).

Keys that are not optional are always present. `null` stands for a number that is not known. In a path such as
`at[].low`, `[]` stands for the items of a list. A unit in the third column is that of the value; without one the value
is a text, a count, a ratio or an object."""

TYPES = {"string": "text", "number": "number", "integer": "whole number", "boolean": "flag",
         "object": "object", "null": "null"}


def linked(reference):
    """A link to the table of a definition."""
    name = reference.rsplit("/", 1)[1]
    return f"[{name}](#keys-of-{name})"


def type_of(schema):
    """The type of a value in words."""
    if "$ref" in schema:
        return linked(schema["$ref"])
    if "enum" in schema:
        return ", ".join(f"`{word}`" for word in schema["enum"])
    if "anyOf" in schema:
        if any("maxItems" in one for one in schema["anyOf"]):
            return "number or list of two"
        return " or ".join(type_of(one) for one in reversed(schema["anyOf"]))
    if schema["type"] == "array":
        items = schema["items"]
        return "list of " + type_of(items)
    if isinstance(schema["type"], str):
        return TYPES[schema["type"]]
    return " or ".join(TYPES[one] for one in schema["type"])


def rows(schema, before=""):
    """The rows of a table, those of inner objects with the path of their key."""
    for key, value in schema["properties"].items():
        what = type_of(value)
        if key not in schema["required"]:
            what += " (optional)"
        yield (f"`{before}{key}`", what, value.get("unit", ""), value["description"])
        if "properties" in value:
            yield from rows(value, f"{before}{key}.")
        elif "properties" in value.get("items", {}):
            yield from rows(value["items"], f"{before}{key}[].")


def table(name, schema):
    """The section of a definition."""
    lines = ["", f"### Keys of `{name}`", "", schema["description"]]
    if "anyOf" in schema:
        return lines + ["It is one of", ""] + [f"- {linked(one['$ref'])}" for one in schema["anyOf"]]
    lines += ["", "| key | type | unit | meaning |", "| --- | --- | --- | --- |"]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |"
              for row in rows(schema)]
    return [re.sub(r"\|  \|", "| |", line) for line in lines]


def page(paths):
    """The page: each document with its tables; a table that two documents share stands in the first."""
    yield from INTRODUCTION.splitlines()
    found = {}
    for path in paths:
        with open(path, encoding="utf-8") as file:
            document = json.load(file)
        yield from ["", f"## {document['title']}", ""]
        yield f"Its root is {linked(document['$ref'])}."
        for name, schema in document["$defs"].items():
            if name not in found:
                yield from table(name, schema)
            elif found[name] != schema:
                sys.exit(f"{path}: {name}: another schema has a table of this name")
            found[name] = schema


def main(arguments):
    """Returns the exit code."""
    check = arguments[0] == "--check"
    path, *schemas = arguments[1 if check else 0:]
    lines = list(page(schemas))
    if not check:
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")
        return 0
    with open(path, encoding="utf-8") as file:
        committed = file.read().splitlines()
    changes = list(difflib.unified_diff(committed, lines, path, "schemas", lineterm="", n=0))
    if changes:
        print("\n".join(changes[:12]))
        print("to write the page: ninja file-keys, in the build folder")
    return 1 if changes else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
