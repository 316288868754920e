/* line_labels.c - see line_labels.h.
 *
 *          _1200_             A candidate is a piece of the line as long as the text. The smaller the line's distance from the chord
 *      .--'      '--.         of the piece, the better. A line is divided into stretches, and each stretch gets one number. */
#include "clients/pictures/line_labels.h"

#include "clients/lib/array.h"
#include "clients/pictures/labels.h"
#include "proto/number.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TEXT 240.0        /* height of a number */
#define HALO 70.0         /* width of the line around it */
#define STRETCH 6000.0    /* of a line for each number */
#define MOST_BEND 0.35    /* distance from the chord, in heights of the number */
#define LEAST_LENGTHS 2.5 /* of a line, in lengths of the number */
#define CANDIDATES 48     /* of a stretch */
#define PIECES 8          /* boxes that cover a number */

struct number {
    double x, y, angle; /* the middle; degrees clockwise, from -90 to 90 */
    char text[PROTO_NUMBER_MAX + 1];
};

struct candidate {
    double from[2], to[2], bend;
};

struct work {
    struct svg *s;
    struct labels taken;   /* owns */
    struct number *number; /* owns */
    size_t n, room;
    double *xy,
        *at; /* own: a line as it is drawn, and the length of the way to each of its places */
};

/* ---- one line ---- */

/* Copies the line as it is drawn, closed if it is; returns the number of places, each different from the one before. */
static size_t take_line(struct work *w, const struct shapes *lines, const struct shape *line)
{
    size_t n = 0;
    for (size_t i = 0; i < line->n + line->closed; i++) {
        double p[2];
        svg_drawn(w->s, lines->xy + 2 * (line->first + i % line->n), p);
        double step = n == 0 ? 0 : hypot(p[0] - w->xy[2 * n - 2], p[1] - w->xy[2 * n - 1]);
        if (n > 0 && step == 0)
            continue;
        w->at[n] = n == 0 ? 0 : w->at[n - 1] + step;
        w->xy[2 * n] = p[0];
        w->xy[2 * n + 1] = p[1];
        n++;
    }
    return n;
}

/* The place at that length of the way, between the places i and i + 1. */
static void place_at(const struct work *w, size_t i, double length, double *p)
{
    double t = (length - w->at[i]) / (w->at[i + 1] - w->at[i]);
    for (size_t k = 0; k < 2; k++)
        p[k] = w->xy[2 * i + k] + t * (w->xy[2 * i + 2 + k] - w->xy[2 * i + k]);
}

/* The piece from `from` on, which lies between the places i and i + 1. False: it bends too much. */
static bool look_at(const struct work *w, size_t n, size_t i, double from, double length,
                    struct candidate *c)
{
    size_t end = i;
    while (end + 2 < n && w->at[end + 1] < from + length)
        end++;
    place_at(w, i, from, c->from);
    place_at(w, end, from + length, c->to);
    double dx = c->to[0] - c->from[0], dy = c->to[1] - c->from[1], chord = hypot(dx, dy);
    c->bend = 0;
    for (size_t k = i + 1; k <= end && chord > 0; k++) {
        const double *p = w->xy + 2 * k;
        double off = fabs((p[0] - c->from[0]) * dy - (p[1] - c->from[1]) * dx) / chord;
        c->bend = fmax(c->bend, off);
    }
    return chord > 0.9 * length && c->bend <= MOST_BEND * TEXT;
}

static int by_bend(const void *a, const void *b)
{
    const struct candidate *p = a, *q = b;
    return (p->bend > q->bend) - (p->bend < q->bend);
}

/* ---- room ---- */

static bool is_in_frame(const struct svg *s, double x, double y)
{
    double low[2], high[2];
    svg_frame(s, low, high);
    return x >= low[0] && y >= low[1] && x <= high[0] && y <= high[1];
}

/* Takes the room along the chord; false if some is taken or outside. */
static bool take_room(struct work *w, const struct candidate *c)
{
    struct label_box box[PIECES];
    for (int k = 0; k < PIECES; k++) {
        double t = (k + 0.5) / PIECES, half = 0.6 * TEXT;
        double x = c->from[0] + t * (c->to[0] - c->from[0]);
        double y = c->from[1] + t * (c->to[1] - c->from[1]);
        if (!is_in_frame(w->s, x - half, y - half) || !is_in_frame(w->s, x + half, y + half))
            return false;
        box[k] = (struct label_box){x - half, y - half, x + half, y + half};
    }
    return labels_take(&w->taken, box, PIECES);
}

static bool add_number(struct work *w, const struct candidate *c, const char *text)
{
    if (!array_reserve((void **)&w->number, &w->room, w->n + 1, sizeof *w->number))
        return false;
    double dx = c->to[0] - c->from[0], dy = c->to[1] - c->from[1];
    struct number *number = &w->number[w->n++];
    *number = (struct number){.x = (c->from[0] + c->to[0]) / 2, .y = (c->from[1] + c->to[1]) / 2};
    number->angle = atan2(dx < 0 ? -dy : dy, fabs(dx)) * (180 / M_PI);
    strcpy(number->text, text);
    return true;
}

/* ---- all lines ---- */

/* One number on the stretch between two lengths of the way, if there is a piece for it. False when out of memory. */
static bool label_stretch(struct work *w, size_t n, const char *text, double length, double from,
                          double to)
{
    struct candidate c[CANDIDATES] = {0};
    size_t found = 0, i = 0;
    double step = fmax((to - length - from) / CANDIDATES, length / 8);
    for (double at = from; at + length <= to && found < CANDIDATES; at += step) {
        while (i + 2 < n && w->at[i + 1] <= at)
            i++;
        found += look_at(w, n, i, at, length, &c[found]);
    }
    qsort(c, found, sizeof c[0], by_bend);
    for (size_t k = 0; k < found; k++)
        if (take_room(w, &c[k]))
            return add_number(w, &c[k], text);
    return true;
}

static bool label_line(struct work *w, const struct shapes *lines, const struct shape *line)
{
    char text[PROTO_NUMBER_MAX + 1];
    size_t letters = proto_write_double(text, line->key), n = take_line(w, lines, line);
    double length = (0.58 * (double)letters + 0.5) * TEXT, all = n > 1 ? w->at[n - 1] : 0;
    text[letters] = '\0';
    if (all < LEAST_LENGTHS * length)
        return true;
    size_t stretches = (size_t)fmax(1, floor(all / fmax(STRETCH, 2 * length)));
    bool ok = true;
    for (size_t i = 0; i < stretches && ok; i++)
        ok = label_stretch(w, n, text, length, all * (double)i / (double)stretches,
                           all * (double)(i + 1) / (double)stretches);
    return ok;
}

/* First all halos, so that none covers a number. */
static void draw(const struct work *w)
{
    for (int pass = 0; pass < 2; pass++) {
        svg_numbers_begin(w->s, TEXT, pass == 0 ? HALO : 0);
        for (size_t i = 0; i < w->n; i++) {
            const struct number *number = &w->number[i];
            svg_number(w->s, number->x, number->y, number->angle, TEXT, number->text);
        }
        svg_numbers_end(w->s);
    }
}

static int longer_first(const void *a, const void *b)
{
    const struct shape *p = *(const struct shape *const *)a, *q = *(const struct shape *const *)b;
    if (p->n != q->n)
        return p->n > q->n ? -1 : 1;
    return (p->first > q->first) - (p->first < q->first);
}

bool line_labels_draw(struct svg *s, const struct shapes *lines,
                      bool (*labelled)(const void *ctx, const struct shape *line), const void *ctx)
{
    struct work w = {.s = s};
    const struct shape **line = malloc((lines->n + 1) * sizeof *line);
    size_t n = 0;
    w.xy = malloc(2 * (lines->corners + 1) * sizeof *w.xy);
    w.at = malloc((lines->corners + 1) * sizeof *w.at);
    bool ok = line != NULL && w.xy != NULL && w.at != NULL &&
              labels_init(&w.taken, s->width, s->height, 3 * TEXT, lines->n);
    for (size_t i = 0; i < lines->n && ok; i++)
        if (labelled(ctx, &lines->shape[i]))
            line[n++] = &lines->shape[i];
    if (ok && n > 0)
        qsort(line, n, sizeof *line, longer_first);
    for (size_t i = 0; i < n && ok; i++)
        ok = label_line(&w, lines, line[i]);
    if (ok && w.n > 0)
        draw(&w);
    labels_free(&w.taken);
    free(line);
    free(w.xy);
    free(w.at);
    free(w.number);
    return ok;
}
