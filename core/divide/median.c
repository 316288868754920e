/* median.c - selection by digits, from the top [radix selection; Knuth, TAOCP 3, sec. 5.2.5 sorts so].
 *
 * A coordinate's bits, the sign bit turned and those of negative numbers inverted, are an integer of the
 * same order. A round looks at the highest bit in which the points in question differ and at the ones
 * below it: one digit. It counts the points of each digit, and keeps those that share the median's:
 *
 *      lo                                        hi
 *      | digit smaller |  the median's  | greater |     the next round: the digit below, in the middle
 *
 * Each round uses up DIGIT bits, so there are at most 6 for the first coordinate, and where it is the same
 * for all that remain, 6 more for the second. A selection by pivots from a known sequence, which this
 * was, takes quadratic time on an order that is made for the sequence. */
#include "core/divide/median.h"

#include <string.h>

#define DIGIT 11u /* bits */
#define DIGITS (1u << DIGIT)

/* The key by which points are compared first (word 0), and where that is the same (word 1). */
struct key {
    bool is_y;
    uint64_t flip; /* all ones for descending order */
};

static struct key key_for(unsigned axis, unsigned word)
{
    return (struct key){axis != word, axis == 1 && word == 1 ? UINT64_MAX : 0};
}

static uint64_t key_of(struct key k, struct dt_point p)
{
    double v = (k.is_y ? p.y : p.x) + 0.0; /* -0 becomes 0 */
    uint64_t bits, sign = (uint64_t)1 << 63;
    memcpy(&bits, &v, sizeof bits);
    return (bits & sign ? ~bits : bits | sign) ^ k.flip;
}

struct selection {
    struct dt_point *p;
    uint32_t *from;
    struct dt_stop *stop;
    struct key key;
    unsigned shift;  /* of the digit in the key */
    uint32_t lo, hi; /* the points in question */
    uint32_t count[DIGITS];
};

static uint32_t digit_of(const struct selection *s, uint32_t i)
{
    return (uint32_t)(key_of(s->key, s->p[i]) >> s->shift) & (DIGITS - 1);
}

/* Sets the shift; false: all keys are the same, or it was stopped. */
static bool find_digit(struct selection *s)
{
    uint64_t first = key_of(s->key, s->p[s->lo]), differ = 0;
    for (struct dt_piece at = dt_pieces(s->lo, s->hi); dt_next_piece(s->stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            differ |= key_of(s->key, s->p[i]) ^ first;
    if (differ == 0)
        return false;
    unsigned top = 64 - (unsigned)__builtin_clzll(differ);
    s->shift = top > DIGIT ? top - DIGIT : 0;
    return true;
}

/* The digit of the point that will be number k. */
static uint32_t digit_at(struct selection *s, uint32_t k)
{
    memset(s->count, 0, sizeof s->count);
    for (struct dt_piece at = dt_pieces(s->lo, s->hi); dt_next_piece(s->stop, &at);)
        for (uint32_t i = at.a; i < at.b; i++)
            s->count[digit_of(s, i)]++;
    uint32_t digit = 0, end = s->lo + s->count[0];
    while (end <= k && digit + 1 < DIGITS)
        end += s->count[++digit];
    return digit;
}

static void swap(struct selection *s, uint32_t i, uint32_t j)
{
    struct dt_point t = s->p[i];
    uint32_t f = s->from[i];
    s->p[i] = s->p[j];
    s->from[i] = s->from[j];
    s->p[j] = t;
    s->from[j] = f;
}

/* Points of smaller digits come first, points of greater digits last; the points between them remain in question. */
static void part(struct selection *s, uint32_t digit)
{
    uint32_t smaller = s->lo, greater = s->hi, steps = 0;
    for (uint32_t i = s->lo; i < greater; steps++) {
        if (steps % DT_POLL == 0 && dt_stopped(s->stop))
            return;
        uint32_t d = digit_of(s, i);
        if (d < digit)
            swap(s, i++, smaller++);
        else if (d > digit)
            swap(s, i, --greater);
        else
            i++;
    }
    s->lo = smaller;
    s->hi = greater;
}

struct dt_piece dt_median_part(struct dt_point *p, uint32_t *from, uint32_t n, unsigned axis,
                               struct dt_stop *stop)
{
    struct selection s;
    s.p = p;
    s.from = from;
    s.stop = stop;
    s.lo = 0;
    s.hi = n;
    for (unsigned word = 0; word < 2; word++) {
        s.key = key_for(axis, word);
        while (!dt_stopped(stop) && find_digit(&s))
            part(&s, digit_at(&s, n / 2));
    }
    return (struct dt_piece){s.lo, s.hi, n};
}
