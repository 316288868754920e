/* answer_rows.h - replies with rows of a set: written at once if they are few, else by a stream (row_stream.h). */
#pragma once

#include "server/jobs/answer.h"
#include "server/jobs/server.h"
#include "server/rows/rows.h"

/* Answers with *rows, whose version need not be pinned. Writes them at once if they are few. Otherwise it creates a
 * stream (ANSWER_STREAM), which takes *ids, so that *ids is empty, and rows->made. ids is NULL for a table. The status
 * line must have been written before. rows->view, unless NULL, is ended when the rows have been sent; without a view,
 * the rows are those of now. If there is no memory for pieces: answer_busy. */
void answer_rows(struct server *s, struct answer *a, struct rows *rows, struct dt_ids *ids);

/* The same for rows of places, which it takes over: they are freed when their rows have been sent. */
void answer_places(struct server *s, struct answer *a, struct rows *rows, struct places *places);

/* Answers with a whole table of the version: the status line, then its rows. */
void answer_table(struct server *s, struct answer *a, struct version *v, enum dt_table table,
                  bool cw, bool binary);

/* DT_POINTS with the values of fields after the coordinates; the array, from malloc, moves here, NULL: none. */
void answer_points(struct server *s, struct answer *a, struct version *v, bool binary,
                   const struct dt_field **field, size_t fields);
