#!/usr/bin/env python3
"""What numpy (PTX, PTS) and pypcd4 (PCD) read in the shared data, as tests/io/formats/text/oracle_test.cpp compares it with our
readers.

    python3 -m venv /tmp/oracle && /tmp/oracle/bin/pip install numpy pypcd4
    /tmp/oracle/bin/python tests/oracles/text_oracle.py ../shared/data > tests/oracles/text_expected.json

PTX's poses are applied here, in doubles, in the order of our own formula. Digests: see las_oracle.py; all values as
doubles.
"""
import json
import pathlib
import sys

import numpy as np
from pypcd4 import PointCloud


def digest(values):
    bits = np.ascontiguousarray(values, dtype=np.float64).view(np.uint64)
    with np.errstate(over="ignore"):
        index = np.arange(1, len(bits) + 1, dtype=np.uint64)
        return [f"{int(bits.sum(dtype=np.uint64)):016x}", f"{int((bits * index).sum(dtype=np.uint64)):016x}"]


def described(columns):
    columns = {name: [np.asarray(c) for c in values] for name, values in columns.items()}
    good = np.isfinite(np.column_stack(columns["position"])).all(axis=1)
    return {
        "points": int(good.sum()),
        "dropped": int((~good).sum()),
        "attributes": {name: [digest(c[good]) for c in values] for name, values in columns.items()},
    }


def named(table):
    columns = {"position": [table[:, k] for k in range(3)]}
    if table.shape[1] > 3:
        columns["intensity"] = [table[:, 3]]
    if table.shape[1] > 4:
        columns["color"] = [table[:, k] for k in range(4, 7)]
    return columns


def ptx(path):
    lines = path.read_text().split("\n")
    parts, at = [], 0
    while at < len(lines) and lines[at].strip():
        rows = int(lines[at]) * int(lines[at + 1])
        matrix = np.array([lines[at + i].split() for i in range(6, 10)], dtype=np.float64)
        table = np.array([line.split() for line in lines[at + 10 : at + 10 + rows]], dtype=np.float64)
        missed = (table[:, :3] == 0).all(axis=1)
        x, y, z = (table[:, k].copy() for k in range(3))
        for k in range(3):
            table[:, k] = x * matrix[0, k] + y * matrix[1, k] + z * matrix[2, k] + matrix[3, k]
        table[missed, 0] = np.nan
        parts.append(table)
        at += 10 + rows
    columns = named(np.concatenate(parts))
    columns["intensity"] = [columns["intensity"][0].astype(np.float32)]
    if len(parts) > 1:
        columns["point_source_id"] = [np.repeat(np.arange(1, len(parts) + 1), [len(p) for p in parts])]
    return described(columns)


def pcd(path):
    cloud = PointCloud.from_path(path)
    data, fields = cloud.pc_data, list(cloud.fields)
    columns = {"position": [data[k] for k in "xyz"]}
    if "rgb" in fields:
        packed = np.ascontiguousarray(data["rgb"]).view(np.uint32)
        columns["color"] = [packed >> 16 & 255, packed >> 8 & 255, packed & 255]
    if "normal_x" in fields:
        columns["normal"] = [data[f"normal_{k}"] for k in "xyz"]
    for name in fields:
        if name not in ("x", "y", "z", "rgb", "normal_x", "normal_y", "normal_z"):
            columns[name] = [data[name]]
    return described(columns)


root = pathlib.Path(sys.argv[1])
expected = {}
for path in sorted(root.glob("ptx_pts/*")) + sorted(root.glob("pcd/*.pcd")):
    read = {".ptx": ptx, ".pts": lambda p: described(named(np.loadtxt(p, skiprows=1))), ".pcd": pcd}[path.suffix]
    expected[f"{path.parent.name}/{path.name}"] = read(path)
print(json.dumps(expected, indent=1))
