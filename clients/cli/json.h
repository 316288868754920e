/* json.h - replies as JSON, for --json: one object on a line for each reply.
 *
 *     {"ok":true,"points":3,"rows":[[0,1,2]]}          words of a row: numbers and strings
 *     {"ok":true,"rows":[{"name":"t","points":3}]}     rows with key=value
 *     {"ok":true,"info":{"clients":1}}                 rows key:value
 *     {"ok":true,"set":"t","version":7,"reset":true,"rows":[["point",0,1,2]]}      an event
 *     {"ok":false,"error":"NOSET","message":"..."} */
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include "clients/lib/delaunay_client.h"

/* Whether --json was given, and whether anything has been written. */
void json_choose(void);
bool json_chosen(void);
bool json_written(void);

struct json_reply {
    bool text; /* rows are sentences */
    bool map;  /* the rows are key:value */
    size_t rows;
    bool started, refused;
};

/* Writes a part of a reply to the standard output; a delaunay_part_fn. json_end writes the rest, when the
 * reply is whole; it does nothing if no part came. */
bool json_part(void *ctx, const struct delaunay_part *part);
void json_end(struct json_reply *j);

/* An object without a reply: {"ok":true, then a pair for each call, then }. */
void json_begin(bool ok);
void json_text(const char *key, const char *value);
void json_number(const char *key, size_t value);
void json_key(const char *key); /* and a value that the caller writes */
void json_string(const char *text, size_t len);
void json_finish(void);
