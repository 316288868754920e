/* trace.c - `delaunay trace SET FILE`: fetches the steps of the shelling algorithm and makes a film
 * of them. */
#include "clients/trace.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/command.h"
#include "clients/json.h"
#include "clients/options.h"
#include "clients/part_file.h"
#include "proto/number.h"

/* ---- rows ---- */

enum { MOST_WORDS = 6 };

struct row_word {
    const char *text;
    size_t len;
};

static size_t split(const char *row, size_t len, struct row_word *word)
{
    size_t n = 0;
    for (size_t at = 0; at < len && n < MOST_WORDS; n++) {
        const char *space = memchr(row + at, ' ', len - at);
        size_t end = space != NULL ? (size_t)(space - row) : len;
        word[n] = (struct row_word){row + at, end - at};
        at = end + 1;
    }
    return n;
}

/* How many points each kind names. */
static const struct {
    const char *name;
    unsigned points;
} kinds[] = {
    [STEP_GRID] = {"grid", 0},     [STEP_START] = {"start", 2}, [STEP_SEARCH] = {"search", 2},
    [STEP_FIRST] = {"first", 3},   [STEP_POINT] = {"point", 3}, [STEP_RIGHT] = {"right", 3},
    [STEP_LEFT] = {"left", 3},     [STEP_CAVE] = {"cave", 3},   [STEP_BORDER] = {"border", 2},
    [STEP_REMOVE] = {"remove", 1}, [STEP_HULL] = {"hull", 1},
};

static bool is_word(struct row_word w, const char *text)
{
    return w.len == strlen(text) && memcmp(w.text, text, w.len) == 0;
}

static bool read_id(struct row_word w, uint32_t *v)
{
    return proto_read_u32(w.text, w.len, v);
}

/* Three numbers: a corner and a side, or a centre and a radius. */
static bool read_numbers(const struct row_word *w, struct step *s)
{
    return proto_read_double(w[0].text, w[0].len, &s->x) &&
           proto_read_double(w[1].text, w[1].len, &s->y) &&
           proto_read_double(w[2].text, w[2].len, &s->size);
}

/* The words after the points. */
static bool read_rest(const struct row_word *w, size_t n, struct step *s)
{
    if (s->kind == STEP_GRID)
        return n == 5 && read_numbers(w, s) && read_id(w[3], &s->v[0]) && read_id(w[4], &s->v[1]);
    s->size = HUGE_VAL;
    return n == 0 || (s->kind == STEP_SEARCH && n == 3 && read_numbers(w, s));
}

static bool read_step(const struct model *m, const char *row, size_t len, struct step *s)
{
    struct row_word word[MOST_WORDS];
    size_t n = split(row, len, word), kind = 0;
    while (n > 0 && kind <= STEP_HULL && !is_word(word[0], kinds[kind].name))
        kind++;
    if (n == 0 || kind > STEP_HULL || n < 1 + kinds[kind].points)
        return false;
    *s = (struct step){.kind = (enum step_kind)kind};
    for (unsigned i = 0; i < kinds[kind].points; i++) {
        uint32_t id;
        if (!read_id(word[1 + i], &id) || !model_find(m, id, &s->v[i]))
            return false;
    }
    return read_rest(word + 1 + kinds[kind].points, n - 1 - kinds[kind].points, s);
}

bool trace_take(struct trace *t, const char *row, size_t len)
{
    if (t->n == t->cap) {
        size_t cap = t->cap > 0 ? 2 * t->cap : 256;
        struct step *more = realloc(t->step, cap * sizeof *more);
        if (more == NULL) {
            t->fault = "out of memory";
            return false;
        }
        t->step = more;
        t->cap = cap;
    }
    t->fault = "a row is no step, or the set was edited meanwhile";
    return read_step(t->m, row, len, &t->step[t->n]) && ++t->n > 0;
}

void trace_free(struct trace *t)
{
    free(t->step);
    *t = (struct trace){.n = 0};
}

/* ---- the command ---- */

struct arguments {
    const char *set, *path;
    struct film_options film;
};

static int read_arguments(struct arguments *a, int argc, char **argv)
{
    static const struct option options[] = {{"seconds", required_argument, NULL, 's'},
                                            {"numbers", no_argument, NULL, 'n'},
                                            {"force", no_argument, NULL, 'F'},
                                            {NULL, 0, NULL, 0}};
    int option;
    bool force = false;
    optind = 0;
    while ((option = options_next(argc, argv, "", options)) != -1) {
        if (option == 'n')
            a->film.numbers = true;
        else if (option == 'F')
            force = true;
        else if (option != 's')
            return options_unknown(argv[0], argv, option);
        else if (!proto_read_double(optarg, strlen(optarg), &a->film.seconds) ||
                 !(a->film.seconds >= 1 && a->film.seconds <= 36000))
            return options_wrong(argv[0], "--seconds is from 1 to 36000, not %s", optarg);
    }
    if (argc - optind != 2)
        return options_wrong(argv[0], "trace takes a set and a file");
    a->set = argv[optind];
    a->path = argv[optind + 1];
    if (force || strcmp(a->path, "-") == 0 || !part_file_is_foreign(a->path))
        return EXIT_DONE;
    part_file_refuse(a->path);
    return EXIT_REFUSED;
}

static bool take_row(void *ctx, const struct reply_part *part)
{
    if (part->kind == REPLY_COMMENT)
        return command_show_comment(NULL, part);
    return part->kind != REPLY_ROW || trace_take(ctx, part->text, part->len);
}

static enum delaunay_result fetch(struct delaunay_client *c, const char *set, struct model *m,
                                  struct trace *t)
{
    char line[100];
    enum delaunay_result r = model_fetch(c, set, 0, m);
    t->fault = m->fault;
    if (r == DELAUNAY_OK && m->n == 0) {
        t->fault = "the set is empty";
        r = DELAUNAY_STOPPED;
    }
    if (r != DELAUNAY_OK)
        return r;
    snprintf(line, sizeof line, "TRACE %.64s", set);
    return delaunay_request(c, line, take_row, t);
}

static int failed(const char *about)
{
    fprintf(stderr, "delaunay: %s: %s\n", about, strerror(errno));
    return EXIT_REFUSED;
}

static int write_film(FILE *out, const struct trace *t, const struct arguments *a)
{
    char title[120];
    snprintf(title, sizeof title, "%.64s: circular shelling of %zu points", a->set, t->m->n);
    if (film_write(out, t, title, &a->film))
        return EXIT_DONE;
    fprintf(stderr, "delaunay: out of memory\n");
    return EXIT_REFUSED;
}

static void report(const struct trace *t, const struct arguments *a)
{
    if (!json_chosen()) {
        printf("%s: %zu points, %zu steps\n", a->path, t->m->n, t->n);
        return;
    }
    json_begin(true);
    json_text("file", a->path);
    json_number("points", t->m->n);
    json_number("steps", t->n);
    json_finish();
}

static int write_file(const struct trace *t, const struct arguments *a)
{
    struct part_file f;
    const char *fault = part_file_open(&f, a->path);
    if (fault != NULL)
        return failed(fault);
    int status = write_film(f.out, t, a);
    bool written = part_file_close(&f);
    if (status == EXIT_DONE && (!written || !part_file_keep(&f)))
        status = failed(a->path);
    if (status != EXIT_DONE)
        part_file_drop(&f);
    else
        report(t, a);
    return status;
}

int command_trace(struct delaunay_client *c, int argc, char **argv)
{
    struct arguments a = {0};
    struct model m = {0};
    struct trace t = {.m = &m};
    if (argc == 2 && argv[1][0] != '-')
        return command_any(c, argc, argv);
    int status = read_arguments(&a, argc, argv);
    if (status != EXIT_DONE)
        return status;
    enum delaunay_result r = fetch(c, a.set, &m, &t);
    if (r == DELAUNAY_STOPPED) {
        fprintf(stderr, "delaunay: %s\n", t.fault);
        status = EXIT_REFUSED;
    } else if (r != DELAUNAY_OK) {
        status = command_outcome(c, r);
    } else if (strcmp(a.path, "-") == 0) {
        status = write_film(stdout, &t, &a);
    } else {
        status = write_file(&t, &a);
    }
    trace_free(&t);
    model_free(&m);
    return status;
}
