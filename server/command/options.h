/* options.h - options of a request: keywords in any order, most of them with a value. A table has those of a command. */
#pragma once

#include "server/command/command.h"

enum option_kind {
    OPTION_FLAG,   /* bool: there is no value */
    OPTION_CHOICE, /* unsigned: the number of one of the names */
    OPTION_EITHER, /* bool: the second one of two names */
    OPTION_FINITE, /* double, as of read_finite */
    OPTION_LENGTH, /* double, as of read_length */
    OPTION_COUNT,  /* uint32_t */
    OPTION_WORD,   /* const struct word *: borrows it */
    OPTION_FIELD,  /* const struct dt_field *: of the set */
    OPTION_INSIDE, /* struct inside */
    OPTION_BOX     /* struct dt_point[2]: the lower left and the upper right corner */
};

struct option {
    const char *name;
    enum option_kind kind;
    size_t offset;            /* of its value in what is read */
    const char *what;         /* the value, in errors */
    const char *const *names; /* NULL ends them; the first one has the number `first` */
    unsigned first;
    unsigned bars; /* bits of the rows that it excludes, if they follow */
    /* Whether the value is allowed; if not, the ERR line has been written. NULL: every value is. */
    bool (*check)(struct answer *a, const struct word *w, const void *value);
};

/* The row of the option of that name; n: there is none. */
size_t option_find(const struct option *table, size_t n, const struct word *w);

/* Reads the words of q from `at` on as options, each at most once, of the rows whose bits are `allowed`, into *out. False: the ERR
 * line has been written. */
bool options_read(struct answer *a, const struct request *q, size_t at, const struct dataset *set,
                  const struct option *table, size_t n, unsigned allowed, void *out);
