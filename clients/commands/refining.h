/* refining.h - the options of `draw` and `run` that refine the mesh before it is written: --angle, --area, --length, --keep,
 * --limit. */
#ifndef CLIENTS_REFINING_H
#define CLIENTS_REFINING_H

#include "clients/cli/options.h"
#include "clients/lib/delaunay_client.h"

enum { REFINING_ANGLE = 400, REFINING_AREA, REFINING_LENGTH, REFINING_KEEP, REFINING_LIMIT };

#define REFINING_OPTIONS                                                                           \
    {"angle", required_argument, NULL, REFINING_ANGLE},                                            \
        {"area", required_argument, NULL, REFINING_AREA},                                          \
        {"length", required_argument, NULL, REFINING_LENGTH},                                      \
        {"keep", no_argument, NULL, REFINING_KEEP},                                                \
    {                                                                                              \
        "limit", required_argument, NULL, REFINING_LIMIT                                           \
    }

/* Start with {0}. The texts are borrowed from the arguments; NULL: not given. */
struct refining {
    const char *angle, *area, *length, *limit;
    bool keep;
};

/* Takes one of these options. *known: it is one. Returns a usage error's status, or EXIT_DONE. */
int refining_option(struct refining *r, int option, char **argv, bool *known);

/* Whether the mesh is to be refined. */
bool refining_asked(const struct refining *r);

/* Refines the triangulated set inside the border (`any`; NULL: the same), and says what is left on standard error. Returns the
 * exit status. */
int refining_refine(struct delaunay_client *c, const struct refining *r, const char *set,
                    const char *inside);

#endif
