/* threads.h - a struct dt_pool of plain threads, started for each run: for tests and benches. */
#pragma once

#include "core/delaunay.h"

/* A pool of n threads, 1 <= n <= 64. Nothing to free. */
struct dt_pool threads_pool(unsigned n);
