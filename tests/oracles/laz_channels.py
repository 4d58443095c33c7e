#!/usr/bin/env python3
"""Small LAZ files by LASzip whose points change between scanner channels, for tests/io/formats/las/laz_test.cpp; laz-rs must write
the same bytes.

    python3 -m venv /tmp/oracle && /tmp/oracle/bin/pip install laspy==2.7.0 laszip lazrs numpy
    /tmp/oracle/bin/python tests/oracles/laz_channels.py tests/io

Every value follows from its point's number (`value` below and in the test).
"""
import pathlib
import sys

import laspy
import numpy as np

POINTS = 240


def value(i, k):
    return (((i // (1 + k % 4)) * 2654435761 + k * 2246822519) % 2**32) >> 16


def channels():
    """In blocks, then at random, then all the same."""
    i = np.arange(POINTS)
    return np.where(i < 80, i // 5 % 4, np.where(i < 160, value(4 * i, 3) % 4, 2))


def fields(point_format):
    """Names, and how many bits of the value they take."""
    names = [("X", 16), ("Y", 16), ("Z", 8), ("intensity", 16), ("classification", 8), ("user_data", 8),
             ("scan_angle", 12), ("point_source_id", 2), ("gps_time", 10)]
    names += [("red", 16), ("green", 16), ("blue", 8)] if point_format > 6 else []
    names += [("nir", 16)] if point_format == 8 else []
    return names + [("first", 8), ("second", 2)]


def cloud(point_format):
    header = laspy.LasHeader(point_format=point_format, version="1.4")
    header.scales, header.offsets = np.ones(3), np.zeros(3)
    for name in ("first", "second"):
        header.add_extra_dim(laspy.ExtraBytesParams(name=name, type="u1"))
    las = laspy.LasData(header)
    las.points = laspy.ScaleAwarePointRecord.zeros(POINTS, header=header)
    i = np.arange(POINTS)
    for k, (name, bits) in enumerate(fields(point_format)):
        las[name] = value(i, k) % 2**bits
    las.return_number, las.number_of_returns = 1 + i % 2, np.full(POINTS, 2)
    las.scanner_channel = channels()
    return las


def chunk(path):
    """The bytes of the only chunk: behind the place of the chunk table, up to that table."""
    data = path.read_bytes()
    points = int(np.frombuffer(data, "<u4", 1, 96)[0])
    return data[points + 8:int(np.frombuffer(data, "<i8", 1, points)[0])]


def main(folder):
    for point_format in (6, 7, 8):
        las, path = cloud(point_format), folder / f"channels{point_format}.laz"
        las.write(path, laz_backend=laspy.LazBackend.Lazrs)
        by_lazrs = chunk(path)
        las.write(path, laz_backend=laspy.LazBackend.Laszip)
        assert chunk(path) == by_lazrs
        for backend in (laspy.LazBackend.Lazrs, laspy.LazBackend.Laszip):
            assert np.array_equal(laspy.read(path, laz_backend=backend).points.array, las.points.array)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
