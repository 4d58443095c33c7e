#!/usr/bin/env python3
"""What libE57Format reads in the E57 files of the shared data, as tests/io/formats/e57/oracle_test.cpp compares it with our reader.

    python3 -m venv /tmp/oracle && /tmp/oracle/bin/pip install pye57==0.4.19 numpy
    /tmp/oracle/bin/python tests/oracles/e57_oracle.py ../shared/data/e57 tests/io > tests/oracles/e57_expected.json

Every value of every field of every scan, without the points whose invalid state is not 0, scan after scan. A field
that a scan lacks counts as 0. Integers and floats are compared by a digest (digest.py). Numbers that are computed
(scaled, moved, turned, spherical) depend on the order of operations in the last digit: of them there are two sums, of
x_i and of (i + 1) x_i, and how large the terms of the second are in all.

With --write FILE it writes tests/io/formats/e57/posed.e57 instead: three scans by libE57Format, turned and moved, some
with colours, some with intensities, every tenth point invalid.
"""
import json
import math
import pathlib
import sys

import numpy as np
import pye57
from pye57 import libe57

from digest import digest

CARTESIAN = ["cartesianX", "cartesianY", "cartesianZ"]
SPHERICAL = ["sphericalRange", "sphericalAzimuth", "sphericalElevation"]
GROUPS = {"color": ["colorRed", "colorGreen", "colorBlue"], "normal": ["nor:normalX", "nor:normalY", "nor:normalZ"]}


def read_scan(image, scan):
    """Every field as int64 or float64, and the names of those that are scaled integers."""
    points = scan["points"]
    prototype = libe57.StructureNode(points.prototype())
    count = points.childCount()
    scaled, whole = set(), set()
    fields, buffers = {}, libe57.VectorSourceDestBuffer()
    for i in range(prototype.childCount()):
        node = prototype[i]
        if isinstance(node, libe57.ScaledIntegerNode):
            scaled.add(node.elementName())
        if isinstance(node, libe57.IntegerNode):
            whole.add(node.elementName())
        # pye57 0.4.19 takes int64 arrays for int32 ones; a double holds all integers of these files.
        fields[node.elementName()] = np.zeros(count)
        buffers.append(libe57.SourceDestBuffer(image, node.elementName(), fields[node.elementName()], count, True, True))
    if count:
        reader = points.reader(buffers)
        assert reader.read() == count
        reader.close()
    return {name: v.astype(np.int64) if name in whole else v for name, v in fields.items()}, scaled


def pose_of(scan):
    rotation, translation = np.array([1.0, 0, 0, 0]), np.zeros(3)
    if not scan.isDefined("pose"):
        return rotation, translation, False
    pose = scan["pose"]
    if pose.isDefined("rotation"):
        rotation = np.array([pose["rotation"][k].value() for k in "wxyz"])
    if pose.isDefined("translation"):
        translation = np.array([pose["translation"][k].value() for k in "xyz"])
    return rotation, translation, True


def matrix(q):
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def missing(name, fields):
    """What our reader gives where a scan lacks a field that others have."""
    count = fields["position"].shape[1]
    return np.full((3 if name in GROUPS else 1, count), 187 if name == "color" else 0)  # 187: an albedo of .5


def sums(values):
    weighted = [(i + 1) * v for i, v in enumerate(values.tolist())]
    return [math.fsum(values.tolist()), math.fsum(weighted), math.fsum(map(abs, weighted))]


def describe(path):
    image = libe57.ImageFile(str(path), "r")
    root = image.root()
    stations, scans, computed = [], [], set()
    for i in range(root["data3D"].childCount()):
        scan = root["data3D"][i]
        fields, scaled = read_scan(image, scan)
        computed |= scaled
        names, state = (CARTESIAN, "cartesianInvalidState") if CARTESIAN[0] in fields else (SPHERICAL, "sphericalInvalidState")
        valid = fields.pop(state, np.zeros(len(fields[names[0]]), dtype=np.int64)) == 0
        fields = {name: values[valid] for name, values in fields.items()}
        position = np.array([fields.pop(name) for name in names], dtype=np.float64)
        if names is SPHERICAL:
            r, azimuth, elevation = position
            position = np.array([r * np.cos(elevation) * np.cos(azimuth), r * np.cos(elevation) * np.sin(azimuth),
                                 r * np.sin(elevation)])
        quaternion, translation, posed = pose_of(scan)
        turn = matrix(quaternion)
        moved = posed and (np.any(turn != np.eye(3)) or np.any(translation != 0))
        if moved or names is SPHERICAL or scaled & set(names):
            computed |= {"position", "normal"}
        fields["position"] = turn @ position + translation[:, None] if moved else position
        for group, members in GROUPS.items():
            if all(name in fields for name in members):
                fields[group] = np.array([fields.pop(name) for name in members])
        if "normal" in fields and moved:
            fields["normal"] = turn @ fields["normal"]
        if posed or names is SPHERICAL:
            stations.append([i + 1, *translation.tolist()])
        fields["point_source_id"] = np.full(position.shape[1], i + 1, dtype=np.int64)
        scans.append(fields)
    if len(scans) < 2 and not stations:
        for fields in scans:
            fields.pop("point_source_id")
    attributes = {}
    for name in sorted({name for fields in scans for name in fields}):
        columns = np.concatenate([np.atleast_2d(fields.get(name, missing(name, fields))) for fields in scans], axis=1)
        attributes[name] = [{"sums": sums(c)} if name in computed else {"digest": digest(c)} for c in columns]
    images = root["images2D"].childCount() if root.isDefined("images2D") else 0
    image.close()
    points = sum(fields["position"].shape[1] for fields in scans)
    return {"points": points, "stations": stations, "images": images, "attributes": attributes}


def write_posed(path):
    """Three scans that differ in fields, pose and packing."""
    random = np.random.default_rng(57)
    pathlib.Path(path).unlink(missing_ok=True)
    with pye57.E57(path, mode="w") as e57:
        for quaternion, translation, count in [([0.8, 0.1, -0.3, 0.5], [600000.25, 200000.5, 400.125], 230),
                                               ([0.5, 0.5, 0.5, 0.5], [-3.0, 0.0, 1e-3], 250), (None, None, 210)]:
            data = {name: random.normal(0, 20, count) for name in CARTESIAN}
            data["cartesianInvalidState"] = (random.random(count) < 0.1).astype(np.int8)
            if count != 230:
                data["intensity"] = random.random(count).astype(np.float32)
                data["rowIndex"] = np.arange(count, dtype=np.int32)
                data["columnIndex"] = np.arange(count, dtype=np.int32) // 7
            if count != 210:
                for name in GROUPS["color"]:
                    data[name] = random.integers(0, 256, count).astype(np.uint8)
            pose = {} if quaternion is None else {"rotation": np.array(quaternion) / np.linalg.norm(quaternion),
                                                  "translation": np.array(translation)}
            e57.write_scan_raw(data, name=f"posed {count}", **pose)


if sys.argv[1] == "--write":
    write_posed(sys.argv[2])
else:
    paths = [path for folder in sys.argv[1:] for path in sorted(pathlib.Path(folder).glob("*.e57"))]
    print(json.dumps({path.name: describe(path) for path in paths}, indent=1))
