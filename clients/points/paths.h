/* paths.h - the lines of a file: paths along its points. Together with the points (points_file.h) they are what every reader of a
 * format fills in, and what every writer writes. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PATHS_MOST_NUMBER = INT32_MAX };

struct path {
    size_t first, n;  /* its corners */
    bool closed;      /* from the last corner it goes on to the first one */
    bool hole;        /* of a model's paths: a hole in the polygon of the path before it */
    bool border;      /* otherwise a line */
    uint32_t number;  /* of the line or polygon; the rings of a polygon have the same */
    uint64_t line;    /* of the file, where it begins */
    uint64_t feature; /* of the file, from 1; 0: its format has none */
};

/* A place that says something about the area around it, as far as lines go. */
struct seed {
    double xy[2];
    bool hole; /* the area is outside; otherwise it is number `number` */
    uint32_t number;
};

struct paths {
    struct path *path; /* owns */
    size_t n, cap;
    uint32_t *corner; /* owns: places of points in the file, counted from 0 */
    size_t corners, corners_cap;
    uint32_t number;   /* the caller's: that of the next line or polygon without one */
    bool lines_border; /* the caller's: lines are borders, too */
    bool given;        /* corners are points that the file numbers; none are joined */
    bool faces;        /* what lines enclose is inside, but for holes: a .poly file */
    struct seed *seed; /* owns */
    size_t seeds, seeds_cap;
    size_t segments;    /* the steps of all paths; of no length are left out */
    size_t short_steps; /* steps of no length that were left out, */
    size_t flat_rings,
        same_rings;    /* rings of fewer than three corners, and those that were there already */
    size_t open_rings; /* rings of polygons that do not end where they begin */
};

/* Begin a path, and add a corner to it. False when out of memory. points_file.h ends it. */
bool paths_begin(struct paths *p, bool border, uint32_t number, uint64_t line, uint64_t feature);
bool paths_corner(struct paths *p, size_t place);

/* Takes the next number; false if there is none left. */
bool paths_number(struct paths *p, uint32_t *number);

bool paths_seed(struct paths *p, struct seed seed);

/* The kind and the number in a text such as `border 7` or `line_7`, which our files have; false if it is another text. */
bool paths_read_name(const char *text, size_t len, bool *border, uint32_t *number);

/* The ends of the segments of path i, from step 0 to paths_steps - 1. */
static inline size_t paths_steps(const struct path *p)
{
    return p->n < 2 ? 0 : p->n - 1 + p->closed;
}

static inline void paths_step(const struct paths *p, const struct path *path, size_t step,
                              uint32_t end[2])
{
    end[0] = p->corner[path->first + step];
    end[1] = p->corner[path->first + (step + 1) % path->n];
}

void paths_free(struct paths *p);
