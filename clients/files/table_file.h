/* table_file.h - points from tables: CSV and its relatives, and Triangle's .node files. A plan decides how a table is read
 * (reading/plan.h); here its rows become points. */
#pragma once

#include "clients/points/points_file.h"
#include "clients/points/table_fields.h"
#include "clients/reading/plan.h"

/* Rows of one kind: how many, and the line of the first one. */
struct rows_seen {
    uint64_t n, line;
};

struct table_file {
    struct wish wish; /* the caller's */
    struct plan plan; /* owns; valid after reading */
    struct table_fields fields;
    char using[5 * PLAN_NAME + 80];   /* which columns were taken, "" where that is obvious */
    struct rows_seen nowhere;         /* rows of empty geometries */
    struct rows_seen empty, comments, /* rows of empty values, comments that look like rows, */
        matrices;                     /* and those that begin another matrix of Octave */
    struct rows_seen spanning, lone_quotes;
    uint64_t spanning_end; /* the last line of the first row that spans lines */
    double row[FIELDS_MOST];
};

/* Called now and then with the bytes and points read so far. */
typedef void table_progress_fn(void *ctx, uint64_t bytes, size_t points);

/* Reads all of the open file fd into *f. False at the first bad line unless f->skip_bad, on a read error or out of memory. Before,
 * the caller has zeroed *t except the wish and fields.all, and *f except skip_bad. The caller frees both in any case. f->report gets a
 * note about everything that is not used, skipped or doubtful. */
bool table_file_read(struct table_file *t, struct points_file *f, int fd,
                     table_progress_fn *progress, void *ctx);
void table_file_free(struct table_file *t);
