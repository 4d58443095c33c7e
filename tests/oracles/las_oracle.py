#!/usr/bin/env python3
"""What laspy reads in the LAS and LAZ files of the shared data, as tests/io/formats/las/oracle_test.cpp compares it with our reader.

    python3 -m venv /tmp/oracle && /tmp/oracle/bin/pip install laspy==2.7.0 laszip lazrs numpy
    /tmp/oracle/bin/python tests/oracles/las_oracle.py ../shared/data/las > tests/oracles/las_expected.json

LAZ is decoded twice, by LASzip and by laz-rs, which must agree. Files that neither of ours is to read (old item versions,
wave packets) are left out.

What a digest is: digest.py.
"""
import json
import pathlib
import sys

import laspy
import numpy as np

from digest import digest

# Our name: laspy's names, in order of component.
NAMES = {
    "position": ["X", "Y", "Z"],
    "intensity": ["intensity"],
    "return_number": ["return_number"],
    "number_of_returns": ["number_of_returns"],
    "scan_direction": ["scan_direction_flag"],
    "edge_of_flight_line": ["edge_of_flight_line"],
    "classification": ["classification"],
    "scanner_channel": ["scanner_channel"],
    "scan_angle_rank": ["scan_angle_rank"],
    "scan_angle": ["scan_angle"],
    "user_data": ["user_data"],
    "point_source_id": ["point_source_id"],
    "gps_time": ["gps_time"],
    "color": ["red", "green", "blue"],
    "nir": ["nir"],
}
FLAGS = ["synthetic", "key_point", "withheld", "overlap"]  # bits 0-3 of our class_flags


def describe(path, backend):
    las = laspy.read(path, laz_backend=backend)
    dimensions = set(las.point_format.dimension_names)
    attributes = {}
    for ours, theirs in NAMES.items():
        if all(name in dimensions for name in theirs):
            attributes[ours] = [digest(np.array(las[name])) for name in theirs]
    flags = sum(np.array(las[name]).astype(np.uint8) << bit for bit, name in enumerate(FLAGS) if name in dimensions)
    attributes["class_flags"] = [digest(flags)]
    for name in las.point_format.extra_dimension_names:
        raw = np.array(las.points.array[name])  # as stored, before the scale of an extra byte
        columns = raw.reshape(len(raw), -1)
        attributes[name] = [digest(columns[:, c]) for c in range(columns.shape[1])]
    return {
        "points": len(las.points),
        "scale": list(las.header.scales),
        "offset": list(las.header.offsets),
        "attributes": attributes,
    }


REFUSED = {"fullwave.laz", "point-version-1-point-wise.laz", "simple-laszip-compressor-version-1.2r0.laz"}
files = sorted(path for path in pathlib.Path(sys.argv[1]).glob("*.la[sz]") if path.name not in REFUSED)
described = {path.name: describe(path, laspy.LazBackend.Laszip) for path in files}
for path in files:
    assert describe(path, laspy.LazBackend.LazrsParallel) == described[path.name], path
print(json.dumps(described, indent=1))
