#!/usr/bin/env python3
"""Checks files that wirebench wrote against the JSON Schemas: each dataset.json, report.json,
manifest.json, harness.json and properties file (.yaml) of the given files and folders. Unknown and missing keys
are errors. Usage: check-files.py SCHEMAS [-n LEAST] PATH..."""

import json
import os
import re
import sys

import jsonschema
import yaml

NAMES = {"dataset.json": "dataset", "report.json": "report", "manifest.json": "manifest",
         "harness.json": "harness"}


class Loader(yaml.SafeLoader):
    """Numbers as YAML 1.2 has them: 1e-2 is one, 2026-11-26 is a text."""


Loader.yaml_implicit_resolvers = {
    first: [pair for pair in pairs if pair[0] in ("tag:yaml.org,2002:bool", "tag:yaml.org,2002:null")]
    for first, pairs in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
Loader.add_implicit_resolver(
    "tag:yaml.org,2002:int", re.compile(r"[-+]?[0-9]+$"), list("-+0123456789"))
Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?$"), list("-+.0123456789"))


def read(path):
    """The kind of a file and its content; None: it is of no kind."""
    name = os.path.basename(path)
    if name in NAMES:
        with open(path, encoding="utf-8") as file:
            return NAMES[name], json.load(file)
    if name.endswith(".yaml"):
        with open(path, encoding="utf-8") as file:
            content = yaml.load(file, Loader)
        if isinstance(content, dict) and "wire" in content and "youngs_modulus_MPa" in content:
            return "properties", content
    return None


def files_of(paths):
    """All files of the paths."""
    for path in paths:
        if not os.path.isdir(path):
            yield path
        for folder, folders, names in os.walk(path):
            folders.sort()
            for name in sorted(names):
                yield os.path.join(folder, name)


def matching(schema, definition, content):
    """Of alternatives, the one that the content is meant to be: with the fewest errors."""
    while True:
        if "$ref" in definition:
            definition = schema["$defs"][definition["$ref"].rsplit("/", 1)[1]]
        elif "anyOf" in definition and isinstance(content, dict):
            definition = min(definition["anyOf"], key=lambda one: len(errors(schema, one, content)))
        else:
            return definition


def errors(schema, definition, content):
    """The errors of a content against a definition."""
    whole = {"$defs": schema["$defs"], **definition}
    return list(jsonschema.Draft202012Validator(whole).iter_errors(content))


def explain(schema, error, place=""):
    """The errors behind one, with their place: of alternatives those of the one that was meant."""
    place += "".join(f"[{k}]" if isinstance(k, int) else f".{k}" for k in error.relative_path)
    if error.validator == "anyOf" and isinstance(error.instance, dict):
        one = matching(schema, {"anyOf": error.validator_value}, error.instance)
        for deeper in errors(schema, one, error.instance):
            yield from explain(schema, deeper, place)
    else:
        yield f"{place.lstrip('.') or 'the root'}: {error.message[:300]}"


def main(arguments):
    """Returns the exit code."""
    folder, paths, least = arguments[0], arguments[1:], 1
    if paths[0] == "-n":
        least, paths = int(paths[1]), paths[2:]
    schemas = {}
    count, bad = 0, 0
    for path in files_of(paths):
        found = read(path)
        if not found:
            continue
        count += 1
        kind = found[0]
        if kind not in schemas:
            with open(os.path.join(folder, kind + ".schema.json"), encoding="utf-8") as file:
                schemas[kind] = json.load(file)
            jsonschema.Draft202012Validator.check_schema(schemas[kind])
        schema = schemas[kind]
        for error in errors(schema, {"$ref": schema["$ref"]}, found[1]):
            for line in explain(schema, error):
                print(f"{path}: {line}")
                bad += 1
    if count < least:
        print(f"{' '.join(paths)}: {count} files that have a schema, expected {least} or more")
    return 1 if bad or count < least else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
