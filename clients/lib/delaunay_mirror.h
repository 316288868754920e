/* delaunay_mirror.h - mirrors: a copy of a set that follows it.
 *
 *     struct delaunay_mirror *m = delaunay_mirror_open("localhost", "6374", "cities", NULL, why, sizeof why);
 *     struct delaunay_change change;
 *     while (delaunay_mirror_next(m, -1, &change) == DELAUNAY_OK)
 *         ... change.added, change.triangles_removed ...; delaunay_mirror_point(m, id, xy)
 *     delaunay_mirror_close(m);
 *
 * It has a connection of its own (WATCH; PROTOCOL.md, section 6.5) and connects again when that is lost. The copy changes only
 * inside delaunay_mirror_next, and always shows one version. Memory: linear in the ids given so far, the rings and the constraints; of
 * a million random points about 90 bytes a point are resident, 160 while the first change is applied.
 * A mirror must not be used by two threads at once. */
#ifndef DELAUNAY_MIRROR_H
#define DELAUNAY_MIRROR_H

#include "clients/lib/delaunay_client.h"

#ifdef __cplusplus
extern "C" {
#endif

struct delaunay_mirror;

/* All zero: none of them. Borrowed during the call. */
struct delaunay_mirror_options {
    const char *token;
    const double *within; /* x0, y0, x1, y1: only the points in this box */
    const char *fields;   /* names with commas between, whose values are kept, too */
};

/* Connects, to a host and port, path or URL as delaunay_connect does, and asks for the events of a set. The first change is everything.
 * options may be NULL. NULL on failure, with a sentence in why[room]. The caller owns the mirror. Blocks until the server has agreed. */
struct delaunay_mirror *delaunay_mirror_open(const char *host, const char *port, const char *set,
                                             const struct delaunay_mirror_options *options,
                                             char *why, size_t room);
void delaunay_mirror_close(struct delaunay_mirror *m);

/* Waits for the next change, applies it, and describes it in *change, whose arrays are valid until the next call.
 * timeout_ms: 0, or -1 for no limit; connecting again may take longer. Returns DELAUNAY_OK; DELAUNAY_TIMEOUT: no change yet;
 * DELAUNAY_DROPPED: the set is gone, and so it stays; DELAUNAY_LOST, DELAUNAY_REFUSED, DELAUNAY_BROKEN: the time is up and there
 * is no connection, because the server cannot be reached, refuses, or sends something else; DELAUNAY_NOMEM. In all these cases the
 * copy is as before, and the next call goes on. Cost: proportional to the change. */
enum delaunay_result delaunay_mirror_next(struct delaunay_mirror *m, int timeout_ms,
                                          struct delaunay_change *change);

/* For poll(): readable when something has arrived; call delaunay_mirror_next(m, 0, ...) then, until it returns
 * DELAUNAY_TIMEOUT. -1 while there is no connection. May be another one after each call. */
int delaunay_mirror_descriptor(const struct delaunay_mirror *m);

/* The version of the copy; 0 before the first change. */
uint64_t delaunay_mirror_version(const struct delaunay_mirror *m);

/* The number of points, and an upper limit of ids: all are smaller. */
size_t delaunay_mirror_points(const struct delaunay_mirror *m);
uint32_t delaunay_mirror_ids(const struct delaunay_mirror *m);

/* The coordinates of a point, in xy[2], and the values of the fields asked for, in the order of the options, in value[] (NULL:
 * not wanted; nan: none). False if there is no such point. */
bool delaunay_mirror_point(const struct delaunay_mirror *m, uint32_t id, double *xy, double *value);

/* The neighbours of a point in *ring, in the order of LISTS, valid until the next call of delaunay_mirror_next, and
 * whether it is an interior point. Returns how many; 0 for aliases, before TRIANGULATE, and where there is no such
 * point. */
size_t delaunay_mirror_ring(const struct delaunay_mirror *m, uint32_t id, const uint32_t **ring,
                            bool *interior);

/* All constraints, in the order of CONSTRAINTS, in *rows, valid until the next call of delaunay_mirror_next; of a mirror of a box those
 * that meet it. DELAUNAY_OK. Cost: O(m log m) for m constraints if they have changed since the last call, else constant. */
enum delaunay_result delaunay_mirror_constraints(struct delaunay_mirror *m,
                                                 const struct delaunay_segment **rows, size_t *n);

#ifdef __cplusplus
}
#endif

#endif
