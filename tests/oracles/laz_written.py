#!/usr/bin/env python3
"""Whether LASzip and laz-rs read from the LAZ files that Lucarne writes what laspy reads from their originals.

    python3 -m venv /tmp/oracle && /tmp/oracle/bin/pip install laspy==2.7.0 laszip lazrs numpy
    /tmp/oracle/bin/python tests/oracles/laz_written.py build/release/lucarne ../shared/data/las

Every value of every attribute is compared, as sorted sets of points: a cache keeps no order. The point format has to
be that of the original, and LASzip has to write the same bytes of the same points. Of files that were no LAS: whether laspy opens them at all, their coordinates to the last digit of the text, their intensities, and the
coordinate system of several.
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


def chunks(path):
    """The compressed points: behind the place of the chunk table, up to that table."""
    data = pathlib.Path(path).read_bytes()
    points = int(np.frombuffer(data, "<u4", 1, 96)[0])
    return data[points + 8:int(np.frombuffer(data, "<i8", 1, points)[0])]


def convert_and_export(program, inputs, written, scratch, *options):
    cache = f"{scratch}/foreign.luc"
    for command in (["convert", *inputs, "-o", cache, "--normals", "none", "--overwrite", *options],
                    ["export", cache, "-o", written, "--overwrite"]):
        subprocess.run([str(part) for part in [program, *command]], check=True, stderr=subprocess.DEVNULL)
    return laspy.read(written)


def sorted_rows(table):
    return table[np.lexsort(table.T[::-1])]


def check_foreign(program, data, extension):
    """What is no LAS, or several; yields what was checked and whether it is right."""
    with tempfile.TemporaryDirectory() as scratch:
        written = f"{scratch}/written{extension}"
        rows = np.array([[500000.123, 5400000.456, 100.789], [500100.001, 5400250.25, 99.999]])
        for offset in ([0, 0, 0], [2100000, -4200000, 300], [7150000, -4750000, 1e4]):  # UTM, Swiss, feet
            text = f"{scratch}/rows.xyz"
            np.savetxt(text, rows + offset, fmt="%.3f")
            las = convert_and_export(program, [text], written, scratch)
            same = np.array_equal(sorted_rows(np.rint(las.xyz * 1000)), sorted_rows(np.rint((rows + offset) * 1000)))
            yield f"text at {offset}", same
        for name, low, high in (("ptx_pts/test.pts", -2048, 2047), ("ptx_pts/no-color.ptx", 0, 1),
                                ("e57/pump_155k_rgb_with_image.e57", 0, 1)):
            las = convert_and_export(program, [data / name], written, scratch)
            whole, near = np.asarray(las["original_intensity"], float), np.asarray(las.intensity, float)
            wanted = (whole - low) / (high - low) * 65535
            yield f"{name}, intensity", abs(wanted - near).max() < 0.501 and np.ptp(near) > 1000
        pair = [data / "las/autzen_trim.las", data / "las/autzen_trim.laz"]
        las = convert_and_export(program, pair, written, scratch)
        records = {record.record_id for record in las.header.vlrs if record.user_id == "LASF_Projection"}
        yield "two files of one system", bool(records & {2112, 34735})
        originals = np.concatenate([laspy.read(path).xyz for path in pair])
        yield "two files, coordinates", np.array_equal(sorted_rows(np.rint(las.xyz * 100)), sorted_rows(np.rint(originals * 100)))
        yield "two files of point format 3", las.header.point_format.id == 3
        mixed = [data / "las/autzen_trim.las", data / "las/autzen_trim_7.las"]
        las = convert_and_export(program, mixed, written, scratch)
        ranks = np.asarray(las["scan_angle_rank"], float)
        same = np.rint(ranks / 0.006).astype(int) == np.asarray(las.scan_angle, int)
        yield "scan angles in whole degrees", same[ranks != 0].all() and (ranks != 0).any()


def main(program, folder):
    good = True
    for what, same in check_foreign(program, folder.parent, ".laz"):
        print(f"{what}: {'the same' if same else 'DIFFERENT'}")
        good &= bool(same)
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
            rewritten = scratch + "/again.laz"
            las = laspy.read(written)
            las.write(rewritten, laz_backend=laspy.LazBackend.Laszip)
            same = las.header.point_format.id == original.header.point_format.id and chunks(written) == chunks(rewritten)
            print(f"{name}, point format and LASzip's bytes: {'the same' if same else 'DIFFERENT'}")
            good &= same
    return good


if __name__ == "__main__":
    sys.exit(0 if main(sys.argv[1], pathlib.Path(sys.argv[2])) else 1)
