"""Types of arrays, for type checkers alone: importing numpy.typing takes as long as importing delaunayd.spatial."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike as ArrayLike, NDArray as NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Numbers = NDArray[np.int64]
