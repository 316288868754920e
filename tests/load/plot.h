/* plot.h - latencies as a drawing: by quantile, both axes logarithmic, so that the tail is visible. */
#pragma once

#include "server/ops/histogram.h"

#include <stdbool.h>

/* Writes an SVG file with one curve. False, with the reason on standard error, if it cannot. */
bool plot_latency(const char *path, const char *title, const struct histogram *h);
