/* weights_formula.h - the weights of natural neighbours, once for each kind of number; for weights.c only, which
 * defines, before it includes this file, what is undefined again at its end:
 *
 *     NUMBER                          the type
 *     F(name)                         name with a suffix of its own
 *     DIFFERENCE(a, b)                of two doubles, rounded at most
 *     PLUS, MINUS, TIMES, OVER(a, b)
 *     ROUGH(a)                        to a double
 *     UNIT                            a bound of the relative error of each of these
 *
 * All places are relative to q, and circumcentres are doubled, which changes no ratio of areas.
 *
 * Errors. For a circumcentre of a triangle with sides b, c from a common corner, D = b x c and T = |b| |c| / |D|:
 * each product of D is off by at most 3 units of UNIT, their difference by one more, so D by 4 |b| |c|; |b|^2 by 4
 * of itself, and the numerator N = |b|^2 c' - |c|^2 b' by 7 |b| |c| (|b| + |c|). So N / D is off by at most
 *
 *     T (7 (|b| + |c|) + 4 |N / D|) / (1 - 4 T UNIT) + |N / D|            units,
 *
 * and where it is moved by the corner's place relative to q, by 3 of that and 2 of the sum's length more. The
 * factors below are a little larger: they make up for the rounding of the bounds themselves. */

struct F(vector) {
    NUMBER x, y;
};

/* A doubled circumcentre, its distance from q, and a bound of its error. */
struct F(centre) {
    struct F(vector) at;
    double length, error;
};

/* Of a rim edge and the vertex where it begins, or of a corner of the triangle. */
struct F(rim) {
    struct F(centre) centre; /* of the triangle of the edge and q */
    struct F(vector) at;     /* of the vertex */
    NUMBER share;            /* its weight, but for a factor that all have */
};

struct F(terms) {
    double error;     /* of all terms, by their factors' errors */
    double magnitude; /* the sum of their absolute values, at least */
};

static inline NUMBER F(cross)(struct F(vector) a, struct F(vector) b)
{
    return MINUS(TIMES(a.x, b.y), TIMES(a.y, b.x));
}

static inline NUMBER F(square)(struct F(vector) a)
{
    return PLUS(TIMES(a.x, a.x), TIMES(a.y, a.y));
}

static inline struct F(vector) F(from)(struct dt_point a, struct dt_point b)
{
    return (struct F(vector)){DIFFERENCE(b.x, a.x), DIFFERENCE(b.y, a.y)};
}

/* The place between a and b that is nearest to q, as a share of the way from a to b: the quotient d . e / e . e. Here d = q - a and
 * e = b - a.
 *
 * Errors, in units of UNIT. Let s be the sum of the sizes of d . e's products, over e . e.
 * 1. The products are off by 3 s, and their sum by s more.
 * 2. e . e is off by 4 of itself, and the quotient by 1 of itself more.
 * False: the error may be more than DT_WEIGHTS_ERROR / 8. */
static bool F(along)(struct dt_point a, struct dt_point b, struct dt_point q, double *along)
{
    struct F(vector) d = F(from)(a, q), e = F(from)(a, b);
    NUMBER x = TIMES(d.x, e.x), y = TIMES(d.y, e.y), whole = F(square)(e);
    *along = ROUGH(OVER(PLUS(x, y), whole));
    return 16 * UNIT * (fabs(ROUGH(x)) + fabs(ROUGH(y))) <= DT_WEIGHTS_ERROR / 8 * ROUGH(whole);
}

static inline struct F(vector) F(sum)(struct F(vector) a, struct F(vector) b)
{
    return (struct F(vector)){PLUS(a.x, b.x), PLUS(a.y, b.y)};
}

static inline double F(length)(struct F(vector) a)
{
    double x = ROUGH(a.x), y = ROUGH(a.y);
    return sqrt(x * x + y * y);
}

/* Of the triangle with the sides b and c from the place of q. */
static inline struct F(centre) F(centre_at)(struct F(vector) b, struct F(vector) c)
{
    NUMBER bb = F(square)(b), cc = F(square)(c), area = F(cross)(b, c);
    struct F(centre) r;
    r.at.x = OVER(MINUS(TIMES(bb, c.y), TIMES(cc, b.y)), area);
    r.at.y = OVER(MINUS(TIMES(cc, b.x), TIMES(bb, c.x)), area);
    r.length = F(length)(r.at);
    double lb = F(length)(b), lc = F(length)(c), flat = lb * lc / fabs(ROUGH(area));
    r.error = UNIT * (flat * (7.5 * (lb + lc) + 4.5 * r.length) + 2 * r.length);
    if (!(flat * UNIT < 0x1p-10))
        r.error = HUGE_VAL;
    return r;
}

static inline struct F(centre) F(centre_of)(const struct dt_point p[3], struct dt_point q)
{
    struct F(vector) corner = F(from)(q, p[0]);
    struct F(centre) r = F(centre_at)(F(from)(p[0], p[1]), F(from)(p[0], p[2]));
    double radius = r.length;
    r.at = F(sum)(r.at, F(sum)(corner, corner));
    r.length = F(length)(r.at);
    r.error += UNIT * (4 * radius + 6 * r.length);
    return r;
}

/* Adds a x b to *sum. */
static inline void F(add)(NUMBER *sum, const struct F(centre) * a, const struct F(centre) * b,
                          struct F(terms) * t)
{
    *sum = PLUS(*sum, F(cross)(a->at, b->at));
    t->error += a->length * b->error + b->length * a->error + a->error * b->error;
    t->magnitude += a->length * b->length;
}

/* The weights are the shares over their sum. `error`: of all shares together. DT_RANGE: the weights' errors might add up to
 * more than DT_WEIGHTS_ERROR. If UNIT is 0, they do not (weights.c). */
static enum dt_status F(divide)(const struct F(rim) * rim, double error, struct dt_weigher *w)
{
    NUMBER total = rim[0].share;
    for (uint32_t i = 1; i < w->n; i++)
        total = PLUS(total, rim[i].share);
    if (UNIT > 0 && !(error < DT_WEIGHTS_ERROR / 2 * fabs(ROUGH(total))))
        return DT_RANGE;
    for (uint32_t i = 0; i < w->n; i++)
        w->weight[i] = fmax(0, ROUGH(OVER(rim[i].share, total)));
    return DT_OK;
}

/* Sibson's: the areas, all times eight, that the cell of q takes from the cells around. */
static enum dt_status F(sibson)(struct dt_weigher *w, const atomic_bool *cancel,
                                struct F(centre) * entered, struct F(rim) * rim)
{
    struct F(centre) *here = entered, *to;
    struct F(terms) t = {0, 0};
    uint32_t rims = 0, at = 0; /* at: whose part of a cell it is */
    for (uint32_t i = 0; i < w->n; i++)
        rim[i].share = DIFFERENCE(0, 0);
    for (uint32_t i = 0; i < w->steps; i++) {
        const struct dt_tour_step *s = &w->step[i];
        if (is_cancelled(cancel, i))
            return DT_CANCELLED;
        if (s->kind == DT_TOUR_RIM) {
            to = &rim[rims++].centre;
            *to = F(centre_at)(F(from)(w->place, s->p[0]), F(from)(w->place, s->p[1]));
            F(add)(&rim[at].share, here, to, &t);
            at = rims < w->n ? rims : 0;
            F(add)(&rim[at].share, to, here, &t);
            continue;
        }
        to = &entered[s->triangle];
        if (s->kind == DT_TOUR_ENTER)
            *to = F(centre_of)(s->p, w->place);
        if (i > 0)
            F(add)(&rim[at].share, here, to, &t);
        here = to;
    }
    for (uint32_t i = 0; i < rims; i++)
        F(add)(&rim[i].share, &rim[i].centre, &rim[i == 0 ? rims - 1 : i - 1].centre, &t);
    return F(divide)(rim, t.error + (5 + w->steps) * UNIT * t.magnitude, w);
}

/* Laplace's: the lengths of the edges of q's cell, over the distances of the neighbours beyond them. */
static enum dt_status F(laplace)(struct dt_weigher *w, const atomic_bool *cancel,
                                 struct F(rim) * rim)
{
    uint32_t rims = 0;
    double error = 0, size = 0;
    for (uint32_t i = 0; i < w->steps; i++) {
        const struct dt_tour_step *s = &w->step[i];
        if (is_cancelled(cancel, i))
            return DT_CANCELLED;
        if (s->kind != DT_TOUR_RIM)
            continue;
        rim[rims].at = F(from)(w->place, s->p[0]);
        rim[rims].centre = F(centre_at)(rim[rims].at, F(from)(w->place, s->p[1]));
        rims++;
    }
    for (uint32_t i = 0; i < rims; i++) {
        const struct F(centre) *to = &rim[i].centre, *from = &rim[i == 0 ? rims - 1 : i - 1].centre;
        struct F(vector) edge = {MINUS(from->at.x, to->at.x), MINUS(from->at.y, to->at.y)};
        if (is_cancelled(cancel, i))
            return DT_CANCELLED;
        rim[i].share = OVER(F(cross)(edge, rim[i].at), F(square)(rim[i].at));
        double ends = from->error + to->error, distance = F(length)(rim[i].at);
        error += 1.01 * ends / distance;
        size += (F(length)(edge) + ends) / distance;
    }
    return F(divide)(rim, error + (14 + rims) * UNIT * size, w);
}

/* In the triangle around q: the areas that q cuts it into. */
static enum dt_status F(linear)(struct dt_weigher *w)
{
    const struct dt_point *p = w->step[0].p, q = w->place;
    struct F(vector) a = F(from)(q, p[0]), b = F(from)(q, p[1]), c = F(from)(q, p[2]);
    struct F(rim) corner[3];
    corner[0].share = F(cross)(b, c);
    corner[1].share = F(cross)(c, a);
    corner[2].share = F(cross)(a, b);
    double la = F(length)(a), lb = F(length)(b), lc = F(length)(c);
    return F(divide)(corner, 7 * UNIT * (lb * lc + lc * la + la * lb), w);
}

/* The bytes that the numbers of a tour take. */
static size_t F(room)(const struct dt_weigher *w)
{
    return w->triangles * sizeof(struct F(centre)) + w->n * sizeof(struct F(rim));
}

static enum dt_status F(weigh)(struct dt_weigher *w, const atomic_bool *cancel)
{
    if (w->how == DT_LINEAR)
        return F(linear)(w);
    struct F(centre) *entered = malloc(F(room)(w));
    if (entered == NULL)
        return DT_NOMEM;
    struct F(rim) *rim = (struct F(rim) *)(entered + w->triangles);
    enum dt_status s =
        w->how == DT_NATURAL ? F(sibson)(w, cancel, entered, rim) : F(laplace)(w, cancel, rim);
    free(entered);
    return s;
}

#undef NUMBER
#undef F
#undef DIFFERENCE
#undef PLUS
#undef MINUS
#undef TIMES
#undef OVER
#undef ROUGH
#undef UNIT
