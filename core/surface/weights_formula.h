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

/* A doubled circumcentre, how far it is from q, and how far it may be from where it is. */
struct F(centre) {
    struct F(vector) at;
    double length, error;
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

/* weight[i] = sum[i] / (sum[0] + ... + sum[n - 1]). `error`: of all sums together. DT_RANGE: the weights' errors
 * might add up to more than DT_WEIGHTS_ERROR. Where UNIT is 0, they do not (weights.c). */
static enum dt_status F(divide)(const NUMBER *sum, uint32_t n, double error, double *weight)
{
    NUMBER total = sum[0];
    for (uint32_t i = 1; i < n; i++)
        total = PLUS(total, sum[i]);
    if (UNIT > 0 && !(error < DT_WEIGHTS_ERROR / 2 * fabs(ROUGH(total))))
        return DT_RANGE;
    for (uint32_t i = 0; i < n; i++)
        weight[i] = fmax(0, ROUGH(OVER(sum[i], total)));
    return DT_OK;
}

/* Sibson's: the areas, all times eight, that the cell of q takes from the cells around. room: for as many
 * centres as there are triangles and rim edges, and as many numbers as rim edges. */
static enum dt_status F(sibson)(const struct dt_tour *tour, struct dt_point q,
                                const atomic_bool *cancel, void *room, double *weight)
{
    struct F(centre) *entered = room, *rim = entered + tour->triangles, *here = entered, *to;
    NUMBER *area = (NUMBER *)(rim + tour->rims);
    struct F(terms) t = {0, 0};
    uint32_t rims = 0, at = 0; /* at: whose part of a cell it is */
    for (uint32_t i = 0; i < tour->rims; i++)
        area[i] = DIFFERENCE(0, 0);
    for (uint32_t i = 0; i < tour->steps; i++) {
        const struct dt_tour_step *s = &tour->step[i];
        if (is_cancelled(cancel, i))
            return DT_CANCELLED;
        if (s->kind == DT_TOUR_RIM) {
            to = &rim[rims++];
            *to = F(centre_at)(F(from)(q, s->p[0]), F(from)(q, s->p[1]));
            F(add)(&area[at], here, to, &t);
            at = rims < tour->rims ? rims : 0;
            F(add)(&area[at], to, here, &t);
            continue;
        }
        to = &entered[s->id];
        if (s->kind == DT_TOUR_ENTER)
            *to = F(centre_of)(s->p, q);
        if (i > 0)
            F(add)(&area[at], here, to, &t);
        here = to;
    }
    for (uint32_t i = 0; i < rims; i++)
        F(add)(&area[i], &rim[i], &rim[i == 0 ? rims - 1 : i - 1], &t);
    return F(divide)(area, rims, t.error + (5 + tour->steps) * UNIT * t.magnitude, weight);
}

/* Laplace's: the lengths of the edges of q's cell, over the distances of the neighbours beyond them. The same
 * room is enough, and two numbers more for each rim edge. */
static enum dt_status F(laplace)(const struct dt_tour *tour, struct dt_point q,
                                 const atomic_bool *cancel, void *room, double *weight)
{
    struct F(centre) *rim = room;
    struct F(vector) *v = (struct F(vector) *)(rim + tour->rims);
    NUMBER *ratio = (NUMBER *)(v + tour->rims);
    uint32_t rims = 0;
    double error = 0, size = 0;
    for (uint32_t i = 0; i < tour->steps; i++) {
        const struct dt_tour_step *s = &tour->step[i];
        if (is_cancelled(cancel, i))
            return DT_CANCELLED;
        if (s->kind != DT_TOUR_RIM)
            continue;
        v[rims] = F(from)(q, s->p[0]);
        rim[rims] = F(centre_at)(v[rims], F(from)(q, s->p[1]));
        rims++;
    }
    for (uint32_t i = 0; i < rims; i++) {
        const struct F(centre) *to = &rim[i], *from = &rim[i == 0 ? rims - 1 : i - 1];
        struct F(vector) edge = {MINUS(from->at.x, to->at.x), MINUS(from->at.y, to->at.y)};
        if (is_cancelled(cancel, i))
            return DT_CANCELLED;
        ratio[i] = OVER(F(cross)(edge, v[i]), F(square)(v[i]));
        double ends = from->error + to->error, distance = F(length)(v[i]);
        error += 1.01 * ends / distance;
        size += (F(length)(edge) + ends) / distance;
    }
    return F(divide)(ratio, rims, error + (14 + rims) * UNIT * size, weight);
}

/* Of the triangle p around q: the areas that q cuts it into. */
static enum dt_status F(linear)(const struct dt_point p[3], struct dt_point q, double weight[3])
{
    struct F(vector) a = F(from)(q, p[0]), b = F(from)(q, p[1]), c = F(from)(q, p[2]);
    NUMBER area[3] = {F(cross)(b, c), F(cross)(c, a), F(cross)(a, b)};
    double la = F(length)(a), lb = F(length)(b), lc = F(length)(c);
    return F(divide)(area, 3, 7 * UNIT * (lb * lc + lc * la + la * lb), weight);
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
