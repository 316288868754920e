"""Sets of points for tests of tiles, hard cases first."""

import numpy as np


def line(n, a, b):
    """Points on a line, exactly where a and b are integers."""
    return np.arange(n, dtype=np.float64)[:, None] * [a, b]


def lattice(columns, rows):
    return np.stack(np.meshgrid(np.arange(float(columns)), np.arange(float(rows))), 2).reshape(-1, 2)


def exact_circle():
    """Places whose distance from the origin is exactly 5 * 13 * 17 * 29."""
    r = 5 * 13 * 17 * 29
    x = np.arange(-r, r + 1)
    y = np.sqrt((r * r - x * x).astype(np.float64)).round().astype(np.int64)
    exact = x * x + y * y == r * r
    places = np.column_stack([x[exact], y[exact]])
    return np.unique(np.concatenate([places, places * [1, -1]]), axis=0).astype(np.float64)


def families(n, seed=0):
    """Names and sets of about n points."""
    rng = np.random.default_rng(seed)
    uniform = rng.random((n, 2))
    side = max(1, int(n**0.5))
    around = np.linspace(0, 6.28, n)
    circle = np.column_stack([np.cos(around), np.sin(around)])
    clusters = rng.random((5, 2))[rng.integers(0, 5, n)] + rng.normal(0, 0.001, (n, 2))
    return {
        "uniform": uniform,
        "clusters": clusters,
        "lattice": lattice(side, side),
        "lattice, shuffled": rng.permutation(lattice(side, side)),
        "lattice, turned": lattice(side, side) @ [[0.6, 0.8], [-0.8, 0.6]],
        "circle": circle,
        "circle, exact": rng.permutation(exact_circle())[:n],
        "wheel": np.concatenate([circle, [[0, 0]]]),
        "line across": line(n, 1, 0),
        "line up": rng.permutation(line(n, 0, 3)),
        "diagonal": rng.permutation(line(n, 3, 7)),
        "two lines": np.concatenate([line(n // 2, 1, 0), line(n // 2, 1, 0) + [0.5, 1]]),
        "line and a point": np.concatenate([[[n / 2, 1e6]], line(n, 1, 0)]),
        "cross": np.concatenate([line(n // 2, 1, 0) - [n // 4, 0], line(n // 2, 0, 1) - [0, n // 4]]),
        "thin": uniform * [1, 1e-14],
        "wide": uniform * [1e50, 1e-30],
        "duplicates": np.concatenate([uniform[: n // 3]] * 3),
        "small lattice": rng.integers(0, 6, (n, 2)).astype(np.float64),
        "one place": np.ones((n, 2)),
        "two places": rng.integers(0, 2, n)[:, None] * np.array([[1.0, 2.0]]),
        "exponents": np.sign(uniform - 0.5) * 2.0 ** rng.integers(-140, 200, (n, 2)),
        "outlier": np.concatenate([uniform, [[1e40, -1e30]]]),
        "zeros of both signs": np.concatenate([np.zeros((n // 4, 2)), -np.zeros((n // 4, 2)), uniform[: n // 4]]),
    }
