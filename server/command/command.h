/* command.h - the table of commands, and how a request line becomes a handler's call.
 *
 * A command is one row: its name, how many words it takes, what it needs, its handler, its help.
 * Before the handler runs, the set named by the second word has been looked up and is in the state
 * that the flags ask for. */
#ifndef SERVER_COMMAND_H
#define SERVER_COMMAND_H

#include "server/jobs/listing.h"
#include "server/jobs/server.h"

/* set is NULL for a command without CMD_SET, or if there is none of that name and the command may
 * do without. */
typedef void command_handler(struct server *s, struct dataset *set, const struct request *q,
                             struct answer *a);

enum {
    CMD_SET = 1,      /* the second word names a set */
    CMD_EXISTING = 2, /* which must be there */
    CMD_WRITE = 4, /* and is changed: no other writer is at work on it, and the client may write */
    CMD_FRESH = 8, /* its triangulation, if it has one, is up to date */
    CMD_SEARCH = 2048, /* and has the grid by which searches begin near their place */
    CMD_LIVE = 16,     /* it has a triangulation */
    CMD_OPEN = 32,     /* allowed before AUTH */
    CMD_BODY = 64, /* a body follows the line, and the handler runs when it is there (a->body) */
    CMD_ALL_SETS = 128, /* it is about all sets */
    CMD_FREES = 256, /* it makes sets smaller: possible as long as there is any space on the disk */
    CMD_ADMIN = 1024, /* it is about other clients: not for those who may only read */
    CMD_QUICK = 512   /* so quick that looking at the clock for each would be felt */
};

struct command {
    const char *name;
    unsigned least, most; /* words, the name included; most 0: any number */
    unsigned flags;
    command_handler *handler;
    const char *usage, *help;
};

extern const struct command commands[];
extern const size_t command_count;

const struct command *command_find(const struct word *name);

/* Takes a prefix `TIMEOUT seconds` off a request that has a valid one: *ms is how long it may take,
 * more than 0; without one 0, and the request is as it was. */
void command_take_timeout(struct request *q, int64_t *ms);

/* Carries out the request q, or begins to. Whatever happens, a tells (answer.h). */
void command_run(struct server *s, const struct request *q, struct answer *a);

/* The same for a request whose body is complete, or says what is wrong with the body. As long as the request
 * is to be carried out again (a->next), the load is needed; then it is spent. */
void command_run_body(struct server *s, struct load *l, struct answer *a);

/* Memory ran out while a reply was written: cuts the reply off at `mark` and says so. */
void command_out_of_memory(struct server *s, struct answer *a, size_t mark);

/* How a word of the client's is quoted in an error: at most 32 bytes of it. Use with %.*s. */
#define QUOTED(W) (int)((W)->len < 32 ? (W)->len : 32), (W)->text

/* The error of a request whose words are not those that its command takes. */
void answer_usage(struct answer *a, const struct request *q);

/* Whether the asker's role lets it write; if not, the ERR line has been written. */
bool check_write_role(struct answer *a);

/* ---- reading arguments; false: the ERR line has been written ---- */

bool read_coordinate(struct answer *a, const struct word *w, double *v);
/* The same for a length, named for the error: a coordinate's magnitude, and not negative. */
bool read_length(struct answer *a, const struct word *w, const char *what, double *v);
bool read_point(struct answer *a, const struct word *w, struct dt_point *p);
bool read_id(struct answer *a, const struct word *w, uint32_t *id);

/* The place that the third and the fourth word tell, with what is known about it already. */
bool read_place(struct server *s, struct answer *a, const struct request *q, struct dt_place *p);

/* A whole number, named for the error. */
bool read_count(struct answer *a, const struct word *w, const char *what, uint32_t *n);

/* Reads n words as ids into a new array, which the caller owns; NULL: the error has been told. n >
 * 0. */
uint32_t *read_ids(struct answer *a, const struct word *w, size_t n);

/* The connection that asks shows a token, which may give it a role. SHOWN_LATER: nothing has been
 * decided yet, and the answer says when to carry out the request. */
enum shown { SHOWN_WRONG, SHOWN_GOOD, SHOWN_LATER };
enum shown client_show_token(struct server *s, struct answer *a, const struct word *token);

/* CLIENT LIST, in lines or, for RESP, as one bulk string. */
void client_list(struct server *s, struct answer *a, enum listing_frame frame);

/* A piece of a listing of slow requests, from that whose id is *at - 1 back to that of the id `end`, or
 * to what has been forgotten meanwhile, each written by `tell`. */
bool slowlog_piece(struct server *s, uint64_t *at, uint64_t end, struct listing_rows *rows,
                   void (*tell)(struct buf *out, const struct slow *e));

/* How many slow requests SLOWLOG GET asks for; false: that is no number. */
bool slowlog_wanted(const struct server *s, const struct request *q, uint32_t *n);

/* Names the connection that asks. False: that can be no name. */
bool client_set_name(struct server *s, struct answer *a, const struct word *name);

command_handler cmd_sets, cmd_create, cmd_drop, cmd_stat;                        /* cmd_data.c */
command_handler cmd_add, cmd_del, cmd_move, cmd_get, cmd_points, cmd_coincident; /* cmd_data.c */
command_handler cmd_load;                                                        /* cmd_load.c */
command_handler cmd_triangulate, cmd_check;                                      /* cmd_build.c */

/* Whether a TRIANGULATE that finds the set being edited has been seen to: it waits for the result of
 * a job that does the same, or its error has been told. */
bool triangulate_join(struct server *s, struct dataset *set, const struct request *q,
                      struct answer *a);

command_handler cmd_lists, cmd_triangles, cmd_edges, cmd_hull; /* cmd_query.c */
command_handler cmd_locate, cmd_nearest, cmd_within;           /* cmd_query.c */
command_handler cmd_trace;                                     /* cmd_trace.c */
command_handler cmd_ping, cmd_help, cmd_hello, cmd_quit;       /* cmd_admin.c */
command_handler cmd_snapshot;                                  /* cmd_admin.c */
command_handler cmd_auth;                                      /* cmd_auth.c */
command_handler cmd_info;                                      /* cmd_info.c */
command_handler cmd_client, cmd_slowlog;                       /* cmd_client.c */
command_handler cmd_config;                                    /* cmd_config.c */
command_handler cmd_timeout;                                   /* command.c */

#endif
