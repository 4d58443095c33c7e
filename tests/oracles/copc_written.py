#!/usr/bin/env python3
"""Whether copclib and laspy read from the COPC files that Lucarne writes what laspy reads from their originals.

    python3 -m venv /tmp/oracle && /tmp/oracle/bin/pip install laspy==2.7.0 lazrs copclib==2.6.3 numpy
    /tmp/oracle/bin/python tests/oracles/copc_written.py build/release/lucarne ../shared/data/las

Every value of every attribute is compared, as sorted sets of points; of copclib's, node by node, whether all
points lie in their voxel and the nodes are a tree; of laspy's CopcReader, queries by level and by box. The last
file has enough levels for several pages of hierarchy. What was no LAS is checked as laz_written.py does.
"""
import pathlib
import subprocess
import sys
import tempfile

import copclib
import laspy
import numpy as np
from laz_written import check_foreign, points

FILES = ["1.2-with-color.copc.laz", "autzen_trim.laz", "lone-star.copc.laz", "statue_lion_takanawa.copc.laz",
         "extrabytes.las", "test1_4.las", "autzen_trim_7.las", "4_6_crop.las"]


def run(*command):
    subprocess.run([str(part) for part in command], check=True, stderr=subprocess.DEVNULL)


def check_copclib(path, original):
    """Positions and intensities through the hierarchy, node by node."""
    reader = copclib.FileReader(str(path))
    header = reader.copc_config.las_header
    low, size = np.array([reader.copc_config.copc_info.center_x, reader.copc_config.copc_info.center_y,
                          reader.copc_config.copc_info.center_z]), reader.copc_config.copc_info.halfsize
    low = low - size
    rows, keys = [], set()
    for node in reader.GetAllNodes():
        key = node.key
        keys.add((key.d, key.x, key.y, key.z))
        got = reader.GetPoints(node)
        if len(got) != node.point_count:
            return False, "a node has not its number of points"
        x, y, z = (np.asarray(axis) for axis in (got.x, got.y, got.z))
        side = 2 * size / 2**key.d
        slack = 1e-6 + np.array([header.scale.x, header.scale.y, header.scale.z]) / 2
        for values, cell, corner, part in ((x, key.x, low[0], slack[0]), (y, key.y, low[1], slack[1]),
                                           (z, key.z, low[2], slack[2])):
            if len(values) and (values.min() < corner + cell * side - part
                                or values.max() > corner + (cell + 1) * side + part):
                return False, f"a point of {key} lies outside its voxel"
        rows.append(np.stack([x, y, z, [point.intensity for point in got]], 1))
    for depth, i, j, k in keys:
        if depth and (depth - 1, i // 2, j // 2, k // 2) not in keys:
            return False, "a node has no parent"
    rows = np.concatenate(rows)
    wanted = np.stack([original.x, original.y, original.z, original.intensity], 1)
    rows, wanted = (table[np.lexsort(np.round(table, 6).T[::-1])] for table in (rows, wanted))
    return rows.shape == wanted.shape and np.allclose(rows, wanted, rtol=0, atol=1e-7), f"{len(keys)} nodes"


def check_copc_reader(path, original, names):
    with laspy.CopcReader.open(str(path)) as reader:
        whole = reader.query()
        if not np.array_equal(points(original, names), points(whole, names)):
            return False, "the whole"
        root = reader.query(level=0)
        levels, total = 1, len(root)
        while total < len(original.points):
            total += len(reader.query(level=levels))
            levels += 1
        low, high = np.array(original.header.mins), np.array(original.header.maxs)
        scale, offset = np.array(original.header.scales), np.array(original.header.offsets)
        # Between two places that points can have: laspy rounds boxes.
        low = offset + (np.floor((low - offset) / scale) - 0.75) * scale
        middle = offset + (np.floor((low / 2 + high / 2 - offset) / scale) + 0.25) * scale
        box = laspy.Bounds(mins=low, maxs=middle)
        found = len(reader.query(bounds=box))
        at = np.stack([original.x, original.y, original.z], 1)
        wanted = np.count_nonzero(((at >= low) & (at <= middle)).all(1))
        return total == len(original.points) and found == wanted, f"{levels} levels, box {found} of {wanted}"


program, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
good = True
for what, same in check_foreign(program, folder.resolve().parent, ".copc.laz"):
    print(f"{what}: {'the same' if same else 'DIFFERENT'}", flush=True)
    good &= bool(same)
with tempfile.TemporaryDirectory() as scratch:
    deep = pathlib.Path(scratch) / "survey.las"
    run(program, "generate", "survey", "--points", "2M", "-o", deep)
    for source in [folder / name for name in FILES] + [deep]:
        cache, written = scratch + "/cache.luc", scratch + "/written.copc.laz"
        run(program, "convert", source, "-o", cache, "--normals", "none", "--overwrite")
        run(program, "export", cache, "-o", written, "--overwrite")
        original = laspy.read(source)
        names = list(original.point_format.dimension_names)
        whole = np.array_equal(points(original, names), points(laspy.read(written), names))
        for reader, (same, what) in {"laspy": (whole, "as LAZ"), "copclib": check_copclib(written, original),
                                     "CopcReader": check_copc_reader(written, original, names)}.items():
            print(f"{source.name}, {reader}: {'the same' if same else 'DIFFERENT'} ({what})", flush=True)
            good &= bool(same)
sys.exit(0 if good else 1)
