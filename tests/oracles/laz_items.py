#!/usr/bin/env python3
"""Small LAZ files of point formats 0 to 3 by LASzip, for tests/io/formats/las/laz_test.cpp; laz-rs must write the same bytes.

    python3 -m venv /tmp/oracle && /tmp/oracle/bin/pip install laspy==2.7.0 laszip lazrs numpy
    /tmp/oracle/bin/python tests/oracles/laz_items.py tests/io

Fields change now and then. Times run in even steps, with pauses, steps back, and five trains of pulses at once.
"""
import pathlib
import sys

import laspy
import numpy as np

from laz_channels import chunk, value

POINTS = 600


def times():
    i = np.arange(POINTS)
    odd = value(i, 5) % 8
    steps = np.where(i < 200, np.where(odd < 5, 8, odd - 6), np.where(odd < 6, 8 * odd, 9000 - 4000 * odd))
    train = np.where(i < 350, 0, value(i, 9) % 5 * (value(i, 2) % 3 == 0))
    return 300000 + np.cumsum(np.where(value(i, 7) % 4 == 0, 0, steps)) * 2.0**-20 + train * 1e9


def cloud(point_format):
    header = laspy.LasHeader(point_format=point_format, version="1.2")
    header.scales, header.offsets = np.ones(3), np.zeros(3)
    if point_format in (0, 3):
        for name in ("first", "second"):
            header.add_extra_dim(laspy.ExtraBytesParams(name=name, type="u1"))
    las = laspy.LasData(header)
    las.points = laspy.ScaleAwarePointRecord.zeros(POINTS, header=header)
    i = np.arange(POINTS)
    las.X, las.Y = 1000 * i + value(i, 0) % 700, value(i, 1) - 32768 + 2**30 * (value(i, 3) % 50 == 0)
    las.Z = value(i, 2) % 2**np.where(i < 300, 6, 14)
    las.intensity = value(i, 3) % 2**12
    las.number_of_returns = np.where(i < 300, 1, 1 + value(i, 1) % 7)
    las.return_number = np.where(i < 500, 1 + i % las.number_of_returns, value(i, 2) % 8)
    las.scan_direction_flag, las.edge_of_flight_line = i // 40 % 2, value(i, 3) % 30 == 0
    las.classification, las.synthetic = value(i, 3) % 32, value(i, 7) % 20 == 0
    las.scan_angle_rank = i // 3 % 40 - 20
    las.user_data, las.point_source_id = value(i, 2) % 3, value(i, 3) * (i > 400)
    if point_format in (1, 3):
        las.gps_time = times()
    if point_format in (2, 3):
        grey = value(i, 3)
        las.red, las.green, las.blue = grey, np.where(i % 3, grey, value(i, 1) % 256), np.where(i % 4, grey, value(i, 2))
    if point_format in (0, 3):
        las["first"], las["second"] = value(i, 3) % 256, value(i, 2) % 4
    return las


def main(folder):
    for point_format in range(4):
        las, path = cloud(point_format), folder / f"items{point_format}.laz"
        las.write(path, laz_backend=laspy.LazBackend.Lazrs)
        by_lazrs = chunk(path)
        las.write(path, laz_backend=laspy.LazBackend.Laszip)
        assert chunk(path) == by_lazrs
        for backend in (laspy.LazBackend.Lazrs, laspy.LazBackend.Laszip):
            assert np.array_equal(laspy.read(path, laz_backend=backend).points.array, las.points.array)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
