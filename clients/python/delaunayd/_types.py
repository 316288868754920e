"""Types of arrays, for type checkers alone: importing numpy.typing takes as long as importing delaunayd.spatial. Without NumPy
a client returns arrays of the module array instead."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike as ArrayLike, NDArray as NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Numbers = NDArray[np.int64]
Uint32s = NDArray[np.uint32]
