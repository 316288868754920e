/* delaunay_client.h - talks to a delaunayd: connect, send request lines, read replies part by part.
 *
 *     struct delaunay_client *c = delaunay_connect("localhost", "6374", why, sizeof why);
 *     if (delaunay_request(c, "NEAREST cities 2.35 48.85 3", print_part, stdout) == DELAUNAY_OK)
 * ... delaunay_close(c);
 *
 * Requests may be pipelined: send as many as you like, then receive their replies in order. Sending
 * never deadlocks against a server that waits for its replies to be read: what arrives meanwhile is
 * kept. A client must not be used by two threads at once. Nothing here prints, exits or raises SIGPIPE. C++ can
 * include this header. All names begin with delaunay_ or DELAUNAY_. */
#ifndef DELAUNAY_CLIENT_H
#define DELAUNAY_CLIENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define DELAUNAY_HOST "localhost"
#define DELAUNAY_PORT "6374"

struct delaunay_client;

enum delaunay_result {
    DELAUNAY_OK = 0,  /* carried out */
    DELAUNAY_REFUSED, /* the server answered ERR; delaunay_status has the line; the connection goes
                         on */
    DELAUNAY_BADNAME, /* not a name of a set or a field; nothing was sent */
    DELAUNAY_LOST,    /* the connection ended before the reply did */
    DELAUNAY_BROKEN,  /* the input is not a reply of the protocol */
    DELAUNAY_NOMEM,   /* out of memory */
    DELAUNAY_STOPPED, /* the caller's own callback said stop */
    DELAUNAY_TIMEOUT, /* nothing in the time given */
    DELAUNAY_DROPPED, /* of a mirror: the set has been dropped */
    DELAUNAY_BADREQUEST /* not one whole request line; nothing was sent */
};
/* After LOST, BROKEN, NOMEM and STOPPED the connection is unusable: close it. A mirror makes another one. After TIMEOUT a request
 * that was not sent is still queued, and a reply is still to come: receive again. A function that had begun to send points or to
 * collect bytes cannot be continued after TIMEOUT: the next call returns LOST. */

enum delaunay_part_kind {
    DELAUNAY_PART_OK,      /* the status line of a request that was carried out */
    DELAUNAY_PART_ERR,     /* the status line of one that was refused */
    DELAUNAY_PART_ROW,     /* one of the lines announced */
    DELAUNAY_PART_BYTES,   /* some of the raw bytes announced */
    DELAUNAY_PART_COMMENT, /* a line that starts with '#', before a status line */
    DELAUNAY_PART_EVENT /* the first line of an event, whose rows follow; see delaunay_expect_events */
};

struct delaunay_part {
    enum delaunay_part_kind kind;
    const char *text; /* borrowed; a line comes without its LF, and only a status line with a NUL */
    size_t len;
    bool last; /* the reply ends here */
};

/* A sentence for people, for any number: a static string. */
const char *delaunay_result_text(enum delaunay_result r);

/* Called with every part of a reply (status line, row, raw bytes, comment), which it borrows during
 * the call. False stops. */
typedef bool delaunay_part_fn(void *ctx, const struct delaunay_part *part);

/* Called with the points sent so far, of how many. */
typedef void delaunay_progress_fn(void *ctx, size_t done, size_t total);

/* Connects. host has one of three forms: a name or address, with the port beside it; the path of a Unix socket, which contains
 * a '/'; a URL. `delaunay://[:token@]host[:port]` and `unix://[:token@]/path` are URLs, whose token is sent. With the last two
 * forms port may be NULL. NULL on failure, with a sentence in why[room]. The caller owns the client. Blocks. */
struct delaunay_client *delaunay_connect(const char *host, const char *port, char *why,
                                         size_t room);

/* The same with a time limit in milliseconds for each address of the host, and then for the connection as by
 * delaunay_set_timeout. Looking up a name takes its own time. */
struct delaunay_client *delaunay_connect_within(const char *host, const char *port, int timeout_ms,
                                                char *why, size_t room);

/* From now on functions that block return DELAUNAY_TIMEOUT when nothing has been sent or received for timeout_ms; -1, as at first: no
 * limit. */
void delaunay_set_timeout(struct delaunay_client *c, int timeout_ms);

/* Sends a token (AUTH) and receives the reply. BADREQUEST if it is empty, has blanks or is too long. */
enum delaunay_result delaunay_authenticate(struct delaunay_client *c, const char *token);

void delaunay_close(struct delaunay_client *c);

/* Queues the request line[len]; a line end at its end is left out. Sends when enough is queued; the next receive sends the rest.
 * Blocks while the server does not read. BADREQUEST if it contains a line feed or a NUL byte. The lines that follow LOAD are sent in the
 * same way, one by one; blank lines and comments have no reply. */
enum delaunay_result delaunay_send(struct delaunay_client *c, const char *line, size_t len);

/* Reads the reply to the oldest request that has none yet; part may be NULL. Blocks until the reply
 * is whole. */
enum delaunay_result delaunay_receive(struct delaunay_client *c, delaunay_part_fn *part, void *ctx);

/* The same for a reply in binary form (`POINTS set BINARY` and its like; PROTOCOL.md, section 7):
 * all its bytes in *bytes, *n of them, which the caller frees with free(). If the result is not
 * DELAUNAY_OK there are none, and *bytes is NULL. Words are little-endian, as on the wire. */
enum delaunay_result delaunay_receive_bytes(struct delaunay_client *c, void **bytes, size_t *n);

/* For callers who read events (WATCH) themselves; mirrors do. From now on there may be events between replies, so the caller must
 * receive everything by delaunay_receive_part. */
void delaunay_expect_events(struct delaunay_client *c);

/* Passes the next part of a reply or event to part, which may be NULL, or waits until bytes have been sent or received. If *last, a
 * part has been passed, and the reply or event ends with it. DELAUNAY_TIMEOUT: nothing for timeout_ms (-1: no limit). */
enum delaunay_result delaunay_receive_part(struct delaunay_client *c, int timeout_ms,
                                           delaunay_part_fn *part, void *ctx, bool *last);

/* For poll(): readable when something has arrived that has not been received yet; parts that have been received may be waiting. */
int delaunay_descriptor(const struct delaunay_client *c);

/* Sends and receives, for a string. BADREQUEST if the line has no reply of its own: more than one line, a blank line, a comment, or a
 * request with a body (LOAD, LOADB ...; use the functions below). With replies still to come for requests sent before,
 * receive those first. */
enum delaunay_result delaunay_request(struct delaunay_client *c, const char *line,
                                      delaunay_part_fn *part, void *ctx);

/* Sends the n points x, y of xy[2n] into the set in one request (LOADB): all or none. The reply is
 * to be received. progress may be NULL. */
enum delaunay_result delaunay_send_points(struct delaunay_client *c, const char *set,
                                          const double *xy, size_t n,
                                          delaunay_progress_fn *progress, void *ctx);

/* The same with the values of k fields at the points. `fields` has the k names with commas between. The array value[n * k] has the
 * values of the first point first; nan: none. fields NULL or "": no fields, value may be NULL. */
enum delaunay_result delaunay_send_values(struct delaunay_client *c, const char *set,
                                          const char *fields, const double *xy, const double *value,
                                          size_t n, delaunay_progress_fn *progress, void *ctx);

/* The same with m constraints between these points (LOADB ... CONSTRAINTS): points and constraints count together, or not at all.
 * constraint[4m]: of each the two ends, counted from 0 among the points, 1 for a border or 0 for a line, and the number. split: where
 * constraints cross they get points. */
enum delaunay_result delaunay_send_drawing(struct delaunay_client *c, const char *set,
                                           const char *fields, const double *xy,
                                           const double *value, size_t n,
                                           const uint32_t *constraint, size_t m, bool split,
                                           delaunay_progress_fn *progress, void *ctx);

/* The kind of a constraint. */
struct delaunay_constraint {
    uint32_t number;
    bool border; /* otherwise a line */
    bool split;  /* where constraints cross they get points; otherwise that is refused */
};

/* Sends n pairs of ids of pair[2n], each of which becomes a constraint of that kind and number, in one request (CONSTRAINB): all or none.
 * The reply is to be received. */
enum delaunay_result delaunay_send_constraints(struct delaunay_client *c, const char *set,
                                               const struct delaunay_constraint *what,
                                               const uint32_t *pair, size_t n);

/* Finds the triangles of the n places x, y of xy[2n] in one request (LOCATEB). Each place gets three ids in triangle[3n]: of the
 * triangle that contains it, of several triangles the first in TRIANGLES, outside the hull DELAUNAY_NONE three times. If the
 * result is not DELAUNAY_OK nothing has been written. With replies still to come, receive those first. */
enum delaunay_result delaunay_locate_places(struct delaunay_client *c, const char *set,
                                            const double *xy, size_t n, uint32_t *triangle);

/* The k points nearest to each of the n places (NEARESTB), into id[k n]: k at most 4096, nearest first, padded
 * with DELAUNAY_NONE. Otherwise as above. */
enum delaunay_result delaunay_nearest_places(struct delaunay_client *c, const char *set,
                                             const double *xy, size_t n, uint32_t k, uint32_t *id);

#define DELAUNAY_NONE UINT32_MAX

/* The status line of the last reply received, a NUL-terminated string, empty before the first one;
 * valid until the next receive. */
const struct delaunay_part *delaunay_status(const struct delaunay_client *c);

/* The value of ` key=value` in a status line; false if it has none. *value borrows the line. */
bool delaunay_key(const struct delaunay_part *status, const char *key, const char **value,
                  size_t *len);

/* The same for a whole number; false also if the value is not one. */
bool delaunay_key_number(const struct delaunay_part *status, const char *key, uint64_t *value);

/* The number of rows that an OK line announces. */
uint64_t delaunay_rows(const struct delaunay_part *status);

/* A constraint between two points, a < b; places: x and y of a and of b, in a mirror of a box, else 0. */
struct delaunay_segment {
    uint32_t a, b;
    bool border; /* else a line */
    uint32_t number;
    double places[4];
};

/* The difference between two versions of a set, as mirrors report it. */
struct delaunay_change {
    uint64_t version;
    bool reset; /* the server sent everything; the fields below are still the difference */
    const uint32_t *added, *moved, *gone; /* ids; moved: other coordinates or values */
    size_t n_added, n_moved, n_gone;
    const uint32_t *triangles_added,
        *triangles_removed; /* three ids each, counterclockwise from the smallest */
    size_t n_triangles_added, n_triangles_removed; /* triangles */
    /* Sorted; in a mirror of a box those that come to meet it or do not any more, and `added` also those whose ends have moved. */
    const struct delaunay_segment *constraints_added, *constraints_released;
    size_t n_constraints_added, n_constraints_released;
};

#ifdef __cplusplus
}
#endif

#endif
