/* command.h - what a command is, and the dispatch of requests.
 *
 * A command is one row of a table (server/commands.c). Before its handler runs, the set named by the second word has been looked
 * up and is in the state that the row requires. */
#pragma once

#include "server/bodies/load.h"
#include "server/changes/change.h"
#include "server/jobs/server.h"
#include "server/replies/listing.h"
#include "server/rows/rows.h"

/* set is NULL for a command without CMD_SET, or if there is no set of that name and the command does not require
 * one. */
typedef void command_handler(struct server *s, struct dataset *set, const struct request *q,
                             struct answer *a);

enum {
    CMD_SET = 1,      /* the second word names a set */
    CMD_EXISTING = 2, /* which must be there; of a change, its kind says that */
    CMD_WRITE = 4, /* and is changed: no other writer is at work on it, and the client may write */
    CMD_FRESH = 8, /* its triangulation, if it has one, is up to date */
    CMD_SEARCH = 16,   /* and has the grid by which searches begin near their place */
    CMD_LIVE = 32,     /* it has a triangulation */
    CMD_ALL_SETS = 64, /* it is about all sets */
    CMD_OPEN = 128,    /* allowed before AUTH */
    CMD_ADMIN = 256,   /* it is about other clients: not for those who may only read */
    CMD_QUICK = 512,   /* so quick that looking at the clock for each would be felt */
    CMD_SHARES = 1024  /* reactors carry it out beside each other (command_shares) */
};

/* Reads the change that a request asks for: *c is one of its kind and its set. False: the ERR line has been written. */
typedef bool change_reader(struct server *s, const struct dataset *set, const struct request *q,
                           struct answer *a, struct change *c);

/* The data that is prefetched for requests in a pipeline (prefetch.h): at the place in the third and fourth word, or of a point. Its
 * id is the third word, and it is only read, or edited. */
enum command_prefetch { PREFETCH_NOTHING, PREFETCH_PLACE, PREFETCH_ID, PREFETCH_EDIT };

struct command {
    const char *name;
    unsigned least, most; /* words, the name included; most 0: any number */
    unsigned flags;
    command_handler *handler;
    const char *usage, *help;
    const char *rows; /* the types of its rows in RESP 3 (replies/resp3.h); NULL: it has none */
    /* What clients return of the status line: facts `key:type`, the types being i, d, b and s (integer, double, 1 or yes, text), `?`
     * behind one that may be missing. A single fact is the result, several are a record of facts; NULL: nothing. */
    const char *result;
    enum change_code change; /* the kind of change that it makes; CHANGE_NONE: none */
    change_reader *read;     /* of cmd_change: reads the change; NULL: it has no arguments */
    enum command_prefetch prefetch;
    struct load_shape body; /* follows the line; the handler runs when it is there (a->body) */
};

/* Whether its set must exist. */
static inline bool command_needs_set(const struct command *c)
{
    return ((c->flags & CMD_EXISTING) | (change_kinds[c->change].flags & CHANGE_EXISTING)) != 0;
}

/* NULL: there is none of that name. */
const struct command *command_find(const struct server *s, const struct word *name);

/* The same, but tries the last command first: pipelines often repeat a command. */
const struct command *command_find_again(const struct server *s, struct reactor *r,
                                         const struct word *name);

/* Its index in the table, which is that of its statistics; NULL: an unknown command. */
static inline unsigned command_number(const struct server *s, const struct command *c)
{
    return c != NULL ? (unsigned)(c - s->commands) : STATS_OTHER;
}

/* Whether the request is one that even a turn of the loop that is already long can carry out: PING and the like. */
bool command_is_quick(const struct server *s, struct reactor *r, const struct request *q);

/* Whether a reactor can carry out the request while others are at work: it reads, unless it calls world_alone. */
bool command_shares(const struct server *s, struct reactor *r, const struct request *q);

/* Takes a prefix `TIMEOUT seconds` off a request that has a valid one. *ms becomes the time that the request may take,
 * more than 0. Without a prefix *ms is 0, and the request is unchanged. */
void command_take_timeout(struct request *q, int64_t *ms);

/* Carries out the request q, or begins to; the outcome is in *a (answer.h). */
void command_run(struct server *s, const struct request *q, struct answer *a);

/* The same for a request whose body is complete, or says what is wrong with the body. As long as the request
 * is to be carried out again (a->next), the load is needed; then it is spent. */
void command_run_body(struct server *s, struct load *l, struct answer *a);

/* The request q has been refused. Its body, if it has one, must not be read as requests: it is skipped (load_skip), also
 * behind prefixes of which some are not valid. If a wrong prefix or an unknown command stands before the name of a command
 * with a body, it is unknown whether there is one, and the connection is closed. */
void command_skip_body(struct server *s, const struct request *q, struct answer *a);

/* Out of memory while a reply was written: replaces what follows `mark` by the error. */
void command_out_of_memory(struct server *s, struct answer *a, size_t mark);

/* Finds another set, beside that of the request, as the command needs its own. False: there is none, or it cannot be used now; the
 * request waits, or the ERR line has been written. The reply shows the last change of that set, too. */
bool command_find_other(struct server *s, struct answer *a, const struct word *name,
                        struct dataset **set);

/* A word of the client in an error, at most 32 bytes of it; for %.*s. */
#define QUOTED(W) (int)((W)->len < 32 ? (W)->len : 32), (W)->text

/* The error of a request whose words are not those that its command takes. */
bool answer_usage(struct answer *a);

/* Whether every edge of the version's triangulation is Delaunay; with constraints not: the ERR line has been written. */
bool check_delaunay(struct answer *a, const struct version *v);

/* Whether the asker's role lets it write; if not, the ERR line has been written. */
bool check_write_role(struct answer *a);

/* ---- reading arguments; false: the ERR line has been written ---- */

bool read_number(struct answer *a, const struct word *w, double *v);
/* A finite number, of which -0 becomes 0; `what` names it in the error. */
bool read_finite(struct answer *a, const struct word *w, const char *what, double *v);
bool read_coordinate(struct answer *a, const struct word *w, double *v);
/* The same for a length, which is not negative; `what` names it in the error. */
bool read_length(struct answer *a, const struct word *w, const char *what, double *v);
bool read_point(struct answer *a, const struct word *w, struct dt_point *p);
/* Two opposite corners: *lo <= *hi. */
bool read_box(struct answer *a, const struct word w[4], struct dt_point *lo, struct dt_point *hi);
/* The places of the words 3 to end - 1, a new array of the caller's from dt_pages_grow, also if the result is false. */
bool read_places(struct server *s, struct answer *a, const struct request *q, size_t end,
                 struct places *out);
bool read_id(struct answer *a, const struct word *w, uint32_t *id);

bool check_set_name(struct answer *a, const struct word *w);

/* A field's name, and a value, which may be nan. */
bool read_field_name(struct answer *a, const struct word *w);
bool read_value(struct answer *a, const struct word *w, double *v);

/* Names of fields, `a,b,c`, that may all be the set's (NULL: a new one), without values; NULL: the ERR line has been
 * written. */
struct columns;
struct columns *read_field_names(struct answer *a, const struct dataset *set,
                                 const struct word *names);

/* The set's fields of these names, `*fields` of them, in a new array of the caller's; NULL: the ERR line has been
 * written. */
const struct dt_field **find_fields(struct answer *a, const struct dataset *set,
                                    const struct word *names, size_t *fields);
/* Whether these are names of fields, not too many; false: the ERR line has been written. */
bool check_field_names(struct answer *a, const struct word *names);

/* The field of that name; NULL: the ERR line has been written. */
const struct dt_field *find_field(struct answer *a, const struct dataset *set,
                                  const struct word *w);

/* The number of a constraint. */
bool read_number_of_constraint(struct answer *a, const struct word *w, uint32_t *k);

/* The words after INSIDE: the word *at, if it is a number, is the number of a border; *at moves behind it. */
struct inside;
bool read_inside(struct answer *a, const struct request *q, size_t *at, struct inside *out);

/* The words of a request that say which constraints it is about: BORDER, OF k, SPLIT, each at most once, in any order. */
struct chosen {
    size_t at; /* the first word behind them */
    bool numbered, splits;
    uint32_t what; /* as in struct record_constraint */
};
bool read_chosen(struct answer *a, const struct request *q, size_t from, struct chosen *f);

/* A whole number; `what` names it in the error. */
bool read_count(struct answer *a, const struct word *w, const char *what, uint32_t *n);

/* Parses n > 0 words as ids into a new array of the caller's; NULL: the ERR line has been written. */
uint32_t *read_ids(struct answer *a, const struct word *w, size_t n);
/* The same for ids of points of the set. */
bool read_points(struct answer *a, const struct dt *dt, const struct word *w, size_t n,
                 struct dt_ids *out);

/* Checks a token of the connection, which may give it a role. SHOWN_LATER: the check is delayed; the answer has the
 * time. */
enum shown { SHOWN_WRONG, SHOWN_GOOD, SHOWN_LATER };
enum shown client_show_token(struct server *s, struct answer *a, const struct word *token);

/* CLIENT LIST, in lines or, for RESP, as one bulk string. */
void client_list(struct server *s, struct answer *a, enum listing_frame frame);

/* Appends the row of a client in that list. */
struct session;
void client_row(struct buf *out, const struct session *s);

/* A piece of a listing of slow requests, from id *at - 1 down to `end` or to the oldest one that still exists, each
 * written by `append`. */
bool slowlog_piece(struct server *s, uint64_t *at, uint64_t end, struct listing_rows *rows,
                   void (*append)(struct buf *out, const struct slow *e));

/* Answers SLOWLOG GET with a listing of these pieces. False, without an answer: the count is not a number. */
bool slowlog_get(struct server *s, const struct request *q, struct answer *a, listing_piece *piece,
                 enum listing_frame frame);

/* The name of the connection; empty: it has none. */
const char *client_name(const struct server *s, const struct answer *a);

/* Sets the name of the connection. False: the name is not valid. */
bool client_set_name(struct server *s, struct answer *a, const struct word *name);

command_handler cmd_change;                          /* submits what `read` has read; command.c */
command_handler cmd_sets, cmd_create, cmd_stat;      /* cmd_data.c */
command_handler cmd_ttl, cmd_persist;                /* cmd_data.c */
command_handler cmd_get, cmd_points, cmd_coincident; /* cmd_data.c */
command_handler cmd_fields, cmd_fget;                /* cmd_field.c */
command_handler cmd_load, cmd_fsetb;                 /* cmd_load.c */
change_reader read_expiry, read_new_points, read_ids_to_delete, read_move; /* cmd_data.c */
change_reader read_values_to_set, read_existing_field;                     /* cmd_field.c */
command_handler cmd_triangulate, cmd_check, cmd_digest;                    /* cmd_build.c */
command_handler cmd_constraints, cmd_constrainb;                           /* cmd_constraint.c */
command_handler cmd_regions;                                               /* cmd_region.c */
command_handler cmd_quality;                                               /* cmd_quality.c */
change_reader read_constraints, read_releases;                             /* cmd_constraint.c */
change_reader read_refinement;                                             /* cmd_mesh.c */

/* Carries out a TRIANGULATE of the set, which must have no writer. `rebuild`: even if it is current. */
void triangulate(struct server *s, struct answer *a, struct dataset *set, enum dt_method method,
                 bool rebuild);

command_handler cmd_lists, cmd_triangles, cmd_edges, cmd_hull;                  /* cmd_query.c */
command_handler cmd_locate, cmd_nearest, cmd_within, cmd_locateb, cmd_nearestb; /* cmd_query.c */
command_handler cmd_interpolateb, cmd_weights, cmd_interpolate, cmd_raster, cmd_contour,
    cmd_gradient, cmd_gradientb, cmd_profile, cmd_volume; /* cmd_surface.c */
command_handler cmd_simplify;                             /* cmd_simplify.c */
command_handler cmd_voronoi, cmd_areas, cmd_alpha;        /* cmd_cells.c */
command_handler cmd_trace;                                /* cmd_trace.c */
command_handler cmd_ping, cmd_help, cmd_hello, cmd_quit;  /* cmd_admin.c */
command_handler cmd_snapshot, cmd_backup;                 /* cmd_admin.c */
command_handler cmd_auth;                                 /* cmd_auth.c */
command_handler cmd_client, cmd_slowlog;                  /* cmd_client.c */
command_handler cmd_config;                               /* cmd_config.c */
command_handler cmd_timeout;                              /* command.c */
