#!/usr/bin/env python3
"""Checks a scene of `wirebench solve harness --gltf` against the table of shapes and the harness file.

Usage: gltf.py SCENE.glb SHAPES.csv HARNESS.yaml, with FORCES.csv beside the table
"""
import csv
import hashlib
import json
import os
import struct
import sys

import numpy as np
import yaml

AROUND = 8
TYPES = {5120: "<i1", 5121: "<u1", 5125: "<u4", 5126: "<f4"}
COMPONENTS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}

scene_path, shapes_path, harness_path = sys.argv[1:]
with open(scene_path, "rb") as file:
    raw = file.read()
with open(harness_path, "rb") as file:
    source = file.read()
harness = yaml.safe_load(source)

# The chunks fill the file, aligned.
magic, version, size = struct.unpack_from("<4sII", raw)
assert magic == b"glTF" and version == 2 and size == len(raw)
length, kind = struct.unpack_from("<I4s", raw, 12)
assert kind == b"JSON" and length % 4 == 0
scene = json.loads(raw[20 : 20 + length])
bin_length, kind = struct.unpack_from("<I4s", raw, 20 + length)
assert kind == b"BIN\0" and bin_length % 4 == 0 and 28 + length + bin_length == size
buffer = raw[28 + length :]
assert scene["buffers"] == [{"byteLength": len(buffer)}]

# Views fill the buffer, arrays fill their view; ranges are exact.
ends = [(v["byteOffset"], v["byteOffset"] + v["byteLength"]) for v in scene["bufferViews"]]
assert [0] + [end for _, end in ends] == [begin for begin, _ in ends] + [len(buffer)]
filled = [0] * len(ends)
arrays = []
for accessor in scene["accessors"]:
    view = scene["bufferViews"][accessor["bufferView"]]
    numbers, components = np.dtype(TYPES[accessor["componentType"]]), COMPONENTS[accessor["type"]]
    stride = numbers.itemsize * components
    assert view.get("byteStride", stride) == stride and stride % 4 == 0
    assert accessor["byteOffset"] == filled[accessor["bufferView"]]
    filled[accessor["bufferView"]] += stride * accessor["count"]
    begin = view["byteOffset"] + accessor["byteOffset"]
    values = np.frombuffer(buffer, numbers, accessor["count"] * components, begin)
    values = values.reshape(-1, components).astype(float)
    if "min" in accessor:
        assert (values.min(0) == accessor["min"]).all() and (values.max(0) == accessor["max"]).all()
    if accessor.get("normalized"):
        values = np.maximum(values / (255 if accessor["componentType"] == 5121 else 127), -1)
    arrays.append(values)
assert filled == [v["byteLength"] for v in scene["bufferViews"]]

# The scene: one root node, which turns z up to y up; a node for each branch and item.
def turn(q, v):
    x, y, z, w = q
    R = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.array(R) @ v


nodes = scene["nodes"]
assert scene["scenes"][scene["scene"]]["nodes"] == [0]
assert nodes[0]["children"] == list(range(1, len(nodes)))
assert np.allclose(turn(nodes[0]["rotation"], [0, 0, 1]), [0, 1, 0], atol=1e-12)
assert np.allclose(turn(nodes[0]["rotation"], [1, 0, 0]), [1, 0, 0], atol=1e-12)
branches = [branch["name"] for branch in harness["branches"]]
items = [harness["root"]["name"]]
items += [item["name"] for item in harness["connectors"] + harness["clips"]]
assert [node["name"] for node in nodes[1:]] == branches + items
extras = scene["scenes"][0]["extras"]
assert extras["sha256"] == hashlib.sha256(source).hexdigest() and extras["origin"][:8] == "computed"
assert len(extras["steps"]) <= len(harness["steps"])

# Times and shapes are those of the table.
shapes = {}
with open(shapes_path) as file:
    for row in csv.DictReader(file):
        place = [float(row[k]) for k in ("x_mm", "y_mm", "z_mm")]
        direction = [float(row["direction_" + k]) for k in "xyz"]
        curvature = float(row["curvature_1_m"])
        shape = shapes.setdefault(row["step"], {})
        shape.setdefault(row["branch"], []).append(
            place + direction + [curvature, float(row["s_mm"])]
        )
with open(os.path.join(os.path.dirname(shapes_path), "forces.csv")) as file:
    slid = {(row["step"], row["item"]): row["slid_mm"] for row in csv.DictReader(file)}
animation = scene["animations"][0]
channels = {}
for channel in animation["channels"]:
    sampler = animation["samplers"][channel["sampler"]]
    key = channel["target"]["node"], channel["target"]["path"]
    channels[key] = arrays[sampler["output"]]
    times = arrays[sampler["input"]][:, 0]
    assert np.allclose(times, [0 if t == "natural" else float(t) for t in shapes], rtol=1e-7)
    assert (np.diff(times) > 0).all()

for index, branch in enumerate(branches):
    node = nodes[1 + index]
    mesh = scene["meshes"][node["mesh"]]
    primitive = mesh["primitives"][0]
    assert len(primitive["targets"]) == len(times) - 1 == len(mesh["extras"]["targetNames"])
    weights = channels[1 + index, "weights"].reshape(len(times), -1)
    # One shape at each time; exactly one of them without a weight.
    assert set(weights.flat) == {0, 1} and (weights.sum(0) == 1).all()
    assert sorted(weights.sum(1)) == [0] + [1] * (len(times) - 1)
    base = {name: arrays[i] for name, i in primitive["attributes"].items()}
    changes = [{name: arrays[i] for name, i in target.items()} for target in primitive["targets"]]
    triangles = arrays[primitive["indices"]].astype(int).reshape(-1, 3)
    assert triangles.max() == len(base["POSITION"]) - 1
    radius = node["extras"]["diameter_m"] / 2
    most = extras["curvature_of_brightest_colour_1_m"]
    brightness = []
    for k, shape in enumerate(shapes.values()):
        rows = np.array(shape[branch])
        now = {
            name: base[name] + sum(w * change[name] for w, change in zip(weights[k], changes) if w)
            for name in base
        }
        centres = np.vstack([rows, rows[[0, -1]]])  # the caps are rings of their own
        rings = now["POSITION"].reshape(-1, AROUND, 3) - centres[:, None, :3] / 1e3
        assert len(rings) == len(rows) + 2
        assert np.allclose(np.linalg.norm(rings, axis=2), radius, rtol=0, atol=1e-6 * (1 + radius))
        along = np.einsum("ijk,ik->ij", rings, centres[:, 3:6])
        assert np.abs(along).max() < 1e-6
        normals = now["NORMAL"].reshape(-1, AROUND, 3)
        assert np.allclose(np.linalg.norm(normals, axis=2), 1, atol=1e-6)
        assert np.allclose(normals[:-2] * radius, rings[:-2], atol=2e-6)
        assert np.allclose(normals[-2], -centres[-2, 3:6], atol=1e-6)
        assert np.allclose(normals[-1], centres[-1, 3:6], atol=1e-6)
        colours = now["COLOR_0"].reshape(-1, AROUND, 4)
        assert colours.min() > -0.01 and colours.max() < 1.01 and (colours[..., 3] == 1).all()
        brightness += list(zip(rows[:, 6] / most, colours[: len(rows), 0] @ [0.2, 0.7, 0.1, 0]))
        # Closed, its triangles seen from outside: each edge once in either direction.
        welded = np.unique(np.round(now["POSITION"] / 1e-7), axis=0, return_inverse=True)[1]
        corners = welded.reshape(-1)[triangles]
        edges = corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        directed = set(map(tuple, edges.tolist()))
        assert len(directed) == len(edges) and directed == {(b, a) for a, b in directed}
        a, b, c = (now["POSITION"][triangles[:, i]] for i in range(3))
        volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
        expected = 4 * np.sin(np.pi / 4) * radius**2 * node["extras"]["length_m"]
        # Chords between the rings are shorter than the wire.
        assert 0.95 < volume / expected < 1.01, (branch, volume, expected)
    brightness.sort(key=lambda pair: pair[0])
    assert all(b[1] > a[1] - 0.02 for a, b in zip(brightness, brightness[1:]))

# Boxes follow the ends of the wires: a connector's middle is its centre of mass.
ends = {branch["to"]: branch["name"] for branch in harness["branches"]}
masses = {connector["name"]: connector for connector in harness["connectors"]}
for index, name in enumerate(items):
    node = 1 + len(branches) + index
    rotations = channels[node, "rotation"]
    assert np.allclose(np.linalg.norm(rotations, axis=1), 1, atol=1e-6)
    assert ((rotations[1:] * rotations[:-1]).sum(1) > 0).all()
    for k, (time, shape) in enumerate(shapes.items()):
        middle = channels[node, "translation"][k]
        if name in masses:
            end = np.array(shape[ends[name]][-1])
            centre = np.array(masses[name]["centre_mm"]) / 1e3
            expected = end[:3] / 1e3 + turn(rotations[k], centre)
            assert np.allclose(turn(rotations[k], [1, 0, 0]), end[3:6], atol=1e-6)
            assert np.allclose(middle, expected, atol=1e-6)
        elif index > 0:  # a clip: on its wire
            clip = next(c for c in harness["clips"] if c["name"] == name)
            way = np.array(shape[clip["branch"]])
            at = clip["at_mm"] + float(slid.get((time, name)) or 0)
            expected = [np.interp(at, way[:, 7], way[:, k]) / 1e3 for k in range(3)]
            assert np.allclose(middle, expected, atol=1e-6)
box = scene["meshes"][nodes[-1]["mesh"]]["primitives"][0]
points, faces = arrays[box["attributes"]["POSITION"]], arrays[box["indices"]].astype(int)
a, b, c = points[faces.reshape(-1, 3)].transpose(1, 0, 2)
assert abs(np.einsum("ij,ij->", a, np.cross(b, c)) / 6 - 1) < 1e-12
normals = np.cross(b - a, c - a)
assert np.allclose(normals, arrays[box["attributes"]["NORMAL"]][faces.reshape(-1, 3)[:, 0]])
