#!/usr/bin/env python3
"""Whether LASzip and laz-rs read from the LAZ files that Lucarne writes what laspy reads from their originals.

    python3 -m venv /tmp/oracle && /tmp/oracle/bin/pip install laspy==2.7.0 laszip lazrs numpy
    /tmp/oracle/bin/python tests/oracles/laz_written.py build/release/lucarne ../shared/data/las

Every value of every attribute is compared, as sorted sets of points: a cache keeps no order.
"""
import pathlib
import subprocess
import sys
import tempfile

import laspy
import numpy as np

FILES = ["1.2-with-color.copc.laz", "autzen_trim.laz", "lone-star.copc.laz", "statue_lion_takanawa.copc.laz",
         "extrabytes.las", "test1_4.las", "autzen_trim_7.las", "4_6_crop.las"]


def points(las, names):
    columns = []
    for name in names:
        values = np.asarray(las[name])
        values = values.view(np.int64) if values.dtype == np.float64 else values.astype(np.int64)
        columns.append(values.reshape(len(values), -1))
    table = np.concatenate(columns, 1)
    return table[np.lexsort(table.T[::-1])]


def main(program, folder):
    good = True
    with tempfile.TemporaryDirectory() as scratch:
        for name in FILES:
            cache, written = scratch + "/cache.luc", scratch + "/written.laz"
            for command in (["convert", folder / name, "-o", cache, "--normals", "none", "--overwrite"],
                            ["export", cache, "-o", written, "--overwrite"]):
                subprocess.run([program, *command], check=True, stderr=subprocess.DEVNULL)
            original = laspy.read(folder / name)
            names = list(original.point_format.dimension_names)
            for backend in (laspy.LazBackend.Laszip, laspy.LazBackend.Lazrs, laspy.LazBackend.LazrsParallel):
                same = np.array_equal(points(original, names), points(laspy.read(written, laz_backend=backend), names))
                print(f"{name}, {backend.name}: {'the same' if same else 'DIFFERENT'}")
                good &= same
    return good


if __name__ == "__main__":
    sys.exit(0 if main(sys.argv[1], pathlib.Path(sys.argv[2])) else 1)
