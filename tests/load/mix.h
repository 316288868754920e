/* mix.h - the requests of a load: kinds of commands, drawn at random by weight. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { MIX_KINDS = 11, MIX_LINE_LIMIT = 160, MIX_REQUEST_LIMIT = 32 + 4 * MIX_LINE_LIMIT };

struct mix {
    const char *set;            /* the name of the set; borrows */
    uint32_t points;            /* in the set: requests have ids below this */
    uint32_t weight[MIX_KINDS]; /* of each kind */
    uint32_t weights;           /* their sum; not 0 */
    unsigned lines;             /* of every reply, for a peer of another protocol; 0: ours */
    bool resp;                  /* ours, in the second framing */
    uint64_t state;             /* of the random numbers */
};

enum { MIX_SPAN = 1000000 }; /* coordinates are drawn from 0 to this */

/* Reads `kind[=weight][,...]`; the kinds are listed by mix_names. False if the text is invalid or
 * mixes kinds whose replies are framed differently. */
bool mix_read(struct mix *m, const char *text);
const char *mix_names(void);

/* Writes the next request, at most MIX_REQUEST_LIMIT bytes, and returns its length. */
size_t mix_next(struct mix *m, char *to);

/* Uniform below n; n > 0. */
uint32_t mix_random(struct mix *m, uint32_t n);
