/* load.h - the body of a request: points, or places, that follow its line. They are collected as they
 * arrive; when they are all there, the request is carried out, as any other is. */
#pragma once

#include "proto/body.h"
#include "proto/reply.h"
#include "proto/request.h"
#include "server/bodies/parser.h"
#include "server/jobs/answer.h"
#include "server/jobs/server.h"

/* The body of a command's requests. */
enum load_rows {
    LOAD_NOTHING,
    LOAD_POINTS, /* to be added to the set */
    LOAD_PLACES,
    LOAD_VALUES,
    LOAD_PAIRS /* of ids; the last word counts them */
};
struct load_shape {
    enum load_rows rows; /* LOAD_NOTHING: no body */
    unsigned count;      /* the index of the word that counts the rows */
    /* the rows are lines; without a count they end with `.`. Otherwise they are binary */
    bool lines;
    /* the last two words may be FIELDS and names: each row has values of these fields, too */
    bool fields;
    bool paths; /* the word PATHS may follow the count, and then others about constraints */
    /* CONSTRAINTS m [SPLIT] may follow the count: m constraints follow the points */
    bool constraints;
};

struct load {
    struct body body;
    struct parser *parser;    /* owns; NULL: the body is fed */
    uint64_t parsed_from;     /* bytes received from which on workers parse a text */
    void (*ready)(void *ctx); /* see load_notify */
    void *ctx;
    const struct load_shape *shape; /* borrows */
    struct server *server;          /* borrows */
    struct reservation memory;      /* of the points received so far */
    enum reply_code shortage;       /* the error if there is no memory for more */
    size_t expected;                /* bytes to prefault for them (page_cache.h) */
    bool adds;                      /* the points are to be added to a set */
    uint64_t came, seen;            /* bytes received; and when load_stalls last saw progress */
    int64_t seen_ms;                /* when that was; 0: not yet */
    bool refused;                   /* the error has been sent: the body is only skipped */
    struct buf line;                /* owns: the words of the request, separated by blanks */
};

/* Begins to receive the body of q: a->load. If the line does not say how long the body is, the ERR line has been written. */
void load_start(struct server *s, const struct load_shape *shape, const struct request *q,
                struct answer *a);

/* The request q has been refused. Its body is skipped if the line says how long it is; otherwise it is unknown where
 * the next request begins, and the connection is closed. */
void load_skip(struct server *s, const struct load_shape *shape, const struct request *q,
               struct answer *a);

/* Writes the error of a complete body; false: it is valid. */
bool load_refuse(struct server *s, const struct load *l, struct answer *a);

/* Feeds bytes to the body (body_feed). Beyond --max-memory the body fails. */
ptrdiff_t load_feed(struct load *l, const char *bytes, size_t n, bool last);

/* Whether the server is to be changed, by load_settle: the memory that the points will take has changed (page_cache.h), or
 * the parser has a block for the workers. */
bool load_has_changed(const struct load *l);
void load_settle(struct load *l);

/* Sets the callback ready(ctx) for when the load can continue: workers have parsed a block. */
void load_notify(struct load *l, void (*ready)(void *ctx), void *ctx);

/* Returns the place at which the next bytes of the body can be received: *n at most (body_room, parser_room). NULL: they must be
 * fed or, if there is a parser, nothing is received for now. */
char *load_room(struct load *l, size_t *n);

/* n bytes have been received at load_room's place. */
void load_received(struct load *l, size_t n);

/* The parser has appended points (PARSER_MOVED). */
void load_moved(struct load *l);

/* The parser is done: the bytes that it has received and not parsed go back to the front of the input. Returns the number
 * of bytes. Without memory for that in->failed is set. */
size_t load_end_parser(struct load *l, struct buf *in);

/* Whether the body has made too little progress for --load-timeout. To be called once a second while it is being
 * received. */
bool load_stalls(struct load *l, int64_t now_ms);

/* The words that may follow the count of the rows. */
struct load_words {
    struct word names; /* of the fields that come with the points, `a,b,c`; len 0: none */
    size_t end;        /* the index behind the words before FIELDS and names */
    size_t paths;      /* the index of the word PATHS; 0: there is none */
    /* CONSTRAINTS m [SPLIT] announce m records behind the points of a body. A record is as long as a point with its
     * values, and has the ends of a constraint, its kind and its number as u32. */
    struct {
        uint32_t n;
        bool splits;
        size_t end; /* the index of the word behind these; 0: they are not there */
        bool bad;   /* m is no number of constraints */
    } constraints;
};
struct load_words load_words_of(const struct load_shape *shape, const struct request *q);

/* Moves the rows to the caller, and their memory to `memory`, which may have some already. */
double *load_take(struct load *l, struct reservation *memory);

/* A copy of the rows, which the caller owns (dt_pages_release); NULL: out of memory, or there are none. */
double *load_copy(const struct load *l);

/* For points that are about to be added: returns the bytes that are to be free meanwhile, for what follows, which are the
 * caller's to announce from now on (page_cache_expect). */
size_t load_hand_on_expected(struct server *s, struct load *l);

void load_free(struct server *s, struct load *l);
