/* mirror.h - a client that follows a set: its rows by id, from events alone. Any failure ends the test. */
#pragma once

#include "tests/server/daemon.h"

enum { MIRROR_IDS = 8192, MIRROR_CONSTRAINTS = 4096 };

/* The options of a watch of set `t`. */
struct mirror_options {
    const char *fields; /* names, separated by commas; NULL: none */
    const char *box;    /* x0 y0 x1 y1; NULL: all points */
    bool resp;          /* RESP 3 */
    bool constraints;
};

/* Start with the options and {0}. */
struct mirror {
    struct mirror_options options;
    int fd;
    uint64_t version;
    unsigned resets;
    unsigned long rows; /* of all events so far */
    bool whole, dropped;
    char *point[MIRROR_IDS], *list[MIRROR_IDS]; /* own: rows as in POINTS FIELDS and LISTS */
    char *constraint
        [MIRROR_CONSTRAINTS]; /* own: rows as in CONSTRAINTS, in the box with the places of the ends; NULL: none */
    unsigned events;
    unsigned place_event[MIRROR_IDS],
        ring_event[MIRROR_IDS]; /* the last one that named the id; from 1 */
};

/* The version that a reply names. */
uint64_t version_in(const char *line);

/* Sends a request whose reply is one line with a version. */
uint64_t ask_version(int fd, const char *line);

/* Connects, and watches; with `since`, the mirror already has the state of its version. */
void mirror_watch(struct mirror *m, const struct daemon *d, bool since);

/* Reads the next event, or events up to the one that shows the version. */
void mirror_take(struct mirror *m);
void mirror_catch_up(struct mirror *m, uint64_t version);

/* It has what POINTS, or WITHIN, LISTS and CONSTRAINTS say to the connection fd. */
void mirror_check(struct mirror *m, int fd, bool triangulated);

/* Closes the connection; the copy stays. */
void mirror_disconnect(struct mirror *m);
void mirror_free(struct mirror *m);
