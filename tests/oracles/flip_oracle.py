#!/usr/bin/env python3
"""What NVIDIA's flip-evaluator finds between pairs of pictures that tests/gi/compare/flip_test.cpp makes by the same formulas.

    python3 -m venv /tmp/oracle && /tmp/oracle/bin/pip install flip-evaluator==1.7 numpy
    /tmp/oracle/bin/python tests/oracles/flip_oracle.py > tests/oracles/flip_expected.json

Pictures are linear light in [0, 1]; the errors are LDR-FLIP at the default 67 pixels per degree: their mean and every
`STRIDE`th pixel, row by row.
"""
import json

import flip_evaluator
import numpy as np

STRIDE = 101


def ramps(w, h, second):
    """Smooth colours; the second with darker squares of 8 x 8."""
    y, x = np.mgrid[0:h, 0:w].astype(np.float64)
    picture = np.stack([x / w, y / h, (x + y) / (w + h)], axis=2)
    if second:
        picture *= np.where((x // 8 + y // 8) % 2 == 0, 0.8, 1.0)[:, :, None]
    return picture


def noise(w, h, second):
    """Two different noises, from a multiplicative hash of the value's index."""
    index = np.arange(w * h * 3, dtype=np.uint64) + np.uint64(1000000 if second else 0)
    hashed = (index * np.uint64(2654435761)) & np.uint64(0xFFFFFFFF)
    hashed = ((hashed ^ (hashed >> np.uint64(15))) * np.uint64(2246822519)) & np.uint64(0xFFFFFFFF)
    return ((hashed >> np.uint64(8)).astype(np.float64) / 2.0**24).reshape(h, w, 3)


def thin(w, h, second):
    """A grey wall; the second with a white line one pixel wide and a red dot."""
    picture = np.full((h, w, 3), 0.2)
    if second:
        picture[:, 20] = 1.0
        picture[h // 2, 40] = [1.0, 0.0, 0.0]
    return picture


def extremes(w, h, second):
    """Green against blue on the left, black against white on the right: the largest differences there are."""
    picture = np.zeros((h, w, 3))
    picture[:, : w // 2, 2 if second else 1] = 1.0
    picture[:, w // 2 :] = 1.0 if second else 0.0
    return picture


def shifted(w, h, second):
    """Stripes four pixels wide; the second one pixel further."""
    y, x = np.mgrid[0:h, 0:w]
    stripe = (x + (1 if second else 0)) // 4 % 2
    return np.stack([0.1 + 0.7 * stripe, 0.3 + 0.2 * stripe, 0.5 - 0.4 * stripe], axis=2)


def expected(make, w, h):
    first, second = (make(w, h, s).astype(np.float32) for s in (False, True))
    errors, mean, _ = flip_evaluator.evaluate(first, second, "LDR", inputsRGB=False, applyMagma=False)
    return {"name": make.__name__, "width": w, "height": h, "mean": round(float(mean), 6),
            "pixels": [round(float(e), 5) for e in np.asarray(errors).reshape(-1)[::STRIDE]]}


if __name__ == "__main__":
    pairs = [(ramps, 64, 48), (noise, 61, 37), (thin, 64, 32), (extremes, 48, 24), (shifted, 53, 20), (noise, 5, 3)]
    lines = [json.dumps(expected(*pair)) for pair in pairs]
    print('{"stride": %d, "pairs": [\n %s\n]}' % (STRIDE, ",\n ".join(lines)))
