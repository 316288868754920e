/* power_agree.h - whether a daemon has the sets that it should have. */
#pragma once

#include "server/sets/dataset.h"
#include "tests/server/daemon.h"
#include "tests/server/power/power_history.h"

/* Whether the daemon has these sets and no others: with equal digests, and a correct triangulation. If not, `why` says what
 * differs. */
bool power_agrees(const struct daemon *d, const struct registry *sets, char why[WHY_BYTES]);
