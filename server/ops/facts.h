/* facts.h - the rows `key:value` of INFO. */
#pragma once

#include "proto/buf.h"

#include <stdint.h>

struct facts {
    struct buf text; /* owns: the rows */
    uint64_t n;      /* their number */
};

void facts_add(struct facts *f, const char *key, uint64_t value);
void facts_add_text(struct facts *f, const char *key, const char *value);
