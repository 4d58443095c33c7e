"""A digest of a list of numbers: two exact sums modulo 2^64 over their 64-bit patterns b_i (integers sign-extended,
floats as doubles), sum b_i and sum (i + 1) b_i, so that a changed value and a changed order both show. The same in C++:
tests/io/formats/digest.h.
"""
import numpy as np


def digest(values):
    values = np.asarray(values)
    if values.dtype.kind == "f":
        bits = values.astype(np.float64).view(np.uint64)
    else:
        bits = values.astype(np.int64).view(np.uint64) if values.dtype.kind == "i" else values.astype(np.uint64)
    with np.errstate(over="ignore"):
        index = np.arange(1, len(bits) + 1, dtype=np.uint64)
        return [f"{int(bits.sum(dtype=np.uint64)):016x}", f"{int((bits * index).sum(dtype=np.uint64)):016x}"]
