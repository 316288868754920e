/* bounds.h - every static error bound of core/: by how much rounding may change a value that is computed in
 * doubles before its sign can be wrong.
 *
 * The model. u = 2^-53. Doubles are IEEE's, rounded to nearest, and nothing is contracted
 * (double2.h): an operation whose exact result is r gives r (1 + d), |d| <= u. It gives a value of
 * the sign of r, and 0 only for 0. So the last sum or difference of an expression never spoils the
 * sign of the exact sum of its operands: only the errors of its operands count. Rounding is monotone: a rounded
 * sum of magnitudes is no less than any of them, and no rounded difference of two points of a box
 * exceeds the rounded side of the box.
 *
 * The range. The model holds as long as nothing overflows or underflows. A coordinate that
 * dt_coordinate_ok accepts is 0 or of magnitude 2^-142 to 2^201. So it is a multiple of 2^-194, and
 * a difference of two is one, too, rounded or not. A product or sum of multiples of 2^-a and 2^-b is a
 * multiple of 2^-(a + b), or of the smaller unit, also as it is rounded. So a value of degree k in
 * the coordinates is 0 or at least 2^(-194 k), and below 2^(203 k + 4); for k = 4 that is 2^-776 to
 * 2^816. The bounds below are such values times 2^-102 or more, and quotients of two values of
 * degree 2 lie between 2^-800 and 2^800: all of them are normal doubles.
 *
 * Reading. "8 u of S" means 8 u times S, and |left| the magnitude of a product as it is rounded.
 * Errors are given to first order in u. The neglected terms are below 100 u of these errors. The
 * rounding of the bound itself takes less than 10 u of the bound. The factors leave room for both.
 * tests/core/exact/bounds_test.c measures the errors against exact integers. */
#pragma once

#define DT_U 0x1p-53

#define DT_COORDINATE_LEAST 0x1p-142
#define DT_COORDINATE_MOST 0x1p201

/* ---- orient2d, from one of the points (predicates.h, locate.c, jump.c) ---- */

/* orient2d: left - right, left = (a - c).x (b - c).y, right = (a - c).y (b - c).x.
 *
 * Two differences and a product make an error of 3 u of |left|, and of |right|. Right sign beyond
 * (3 u + 9 u^2)(|left| + |right|); the bound loses 2 u of itself, hence 15 u^2 [Shewchuk 1997, sec.
 * 4.2]. A sum of several such bounds is a bound for each of the determinants. */
#define DT_ORIENT_BOUND ((3 + 16 * DT_U) * DT_U)

/* ---- determinants from two of the points, l and r (sight.h, remove.c, predicates.h, jump.c) ----
 *
 *     cr(c) = (r - l) x (c - l),  dt(c) = (c - l).(c - r),  det(c, x) = dt(c) cr(x) - dt(x) cr(c)
 *
 * cr and dt are of two products each; CR and DT are the sums of their magnitudes. cr(c) may have
 * c - r instead of c - l, or be (l - c) x (r - c). */

/* The wide filter knows only the longer side D of the box of all points concerned. A product of two
 * differences is at most D^2 and errs by 3 u D^2, and so
 *
 *     |err cr| <= 2 * 3 u D^2 + 2 u D^2 = 8 u D^2 < 8.9e-16 D^2,    |err dt| the same.
 *
 * With |cr| <= D^2 (twice the area of a triangle in a square) and |dt| <= 2 D^2
 *
 *     |err det| <= 2 (2 * 8 u + 8 u + 2 u) D^4 + 4 u D^4 = 56 u D^4 < 6.3e-15 D^4. */
#define DT_WIDE_CR_BOUND 1e-15  /* of D^2: > 9 u */
#define DT_WIDE_DET_BOUND 1e-14 /* of D^4: > 90 u */

struct dt_wide_bounds {
    double cr, det;
};

static inline struct dt_wide_bounds dt_wide_bounds_of(double side)
{
    double area = side * side;
    return (struct dt_wide_bounds){DT_WIDE_CR_BOUND * area, DT_WIDE_DET_BOUND * area * area};
}

/* The close filter knows S = DT(c) CR(x) + DT(x) CR(c). A product of two rounded differences errs
 * by 3 u of itself, so |err cr| <= 4 u CR and |err dt| <= 4 u DT, hence each product of a cr and a
 * dt by 9 u CR DT, and
 *
 *     |err det| <= 9 u S + u S = 10 u S. */
#define DT_CLOSE_DET_BOUND 1.2e-15 /* of S: > 10.8 u */

/* The same two determinants in double words (double2.h):
 * 1. A difference is exact, a product errs by 7 u^2 of itself, a sum by 3.1 u^2 of its own result.
 * 2. So orient2d, and cr, err by 7 + 3.1 < 10.2 u^2 of CR; dt errs by 10.2 u^2 of DT.
 * 3. A product of both errs by 10.2 + 10.2 + 7 = 27.4 u^2 of DT CR, their difference by 30.5 u^2 of S.
 * 4. S in doubles, from the higher halves, is right to 1 part in 2^49. The higher half of a double
 *    word has the sign of the whole and is right to 1 part in 2^53. */
#define DT_ORIENT_BOUND_2 0x1p-102   /* of |left| + |right|: 16 u^2 */
#define DT_INCIRCLE_BOUND_2 0x1p-100 /* of S: 64 u^2 */

/* ---- determinants of points relative to a point q, many of them (predicates.h, insert.c, flip.c) ----
 *
 *     a.square = a.x^2 + a.y^2,  a x b = a.x b.y - a.y b.x,  det = sum of a.square (b x c), cyclic
 *
 * Let L be the greatest square. Squares err by 4 u of themselves. |a.x b.y| + |a.y b.x| <= |a| |b| <= L, so a cross product
 * errs by 4 u L, and its product with a square by (4 + 4 + 1) u L^2. Three of these make 27 u L^2, and the first of
 * their two sums 2 u L^2 more. A vertex at infinity, with square 1, makes L >= 1 and the determinant a single cross
 * product: 4 u L. */
#define DT_LIFTED_DET_BOUND 0x1p-48 /* of L^2: 32 u > 29 u */

/* ---- distances (predicates.h, nearest.c) ---- */

/* (a.x - b.x)^2 + (a.y - b.y)^2 errs by 2 u + u in the squares and u in the sum, 4 u of itself. Two
 * of them, or one and the rounded square of a radius, compare as they are rounded where they are
 * more than 4 u (1 + 10 u) of their sum apart. */
#define DT_DISTANCE_BOUND 0x1p-50 /* 8 u */

/* R = |ab| |bc| |ca| / (2 D) for twice the area D. The root of the product of two rounded squares errs by 5.5 u of itself,
 * the root of the third square by 3 u, their product by 9.5 u. 2 r D errs by 4 u of 2 r (|left| + |right|) and 2 u of itself. */
#define DT_SIDES_BOUND 0x1p-49        /* of the product of the sides: 16 u */
#define DT_CIRCUMRADIUS_BOUND 0x1p-50 /* of 2 r (|left| + |right|): 8 u */

/* w.q / |w|^2 for rounded differences w and q: the products err by 3 u of themselves; u for the sum, 4 u for |w|^2, u
 * for the quotient: 9 u. So does w.q |v|^2 in place of w.q / |w|^2 < v.q / |v|^2; u more for w.q with the bound added. */
#define DT_INVERSE_BOUND 0x1p-49 /* of (|w.x q.x| + |w.y q.y|) / |w|^2: 16 u */

/* ---- the third-point search of the paper (scan.c, segment.c) ----
 *
 * For points p whose coordinates relative to a and b are at most R; d = b - a rounded, K = |d.x| +
 * |d.y|.
 *
 *     cross = d x (p - a)             4 u (|d.x y| + |d.y x|) < 4.1 u K R
 *     dot = (p - a).(p - b)           4 u (R^2 + R^2) < 8.1 u R^2
 *     det = dot cross' - dot' cross   each product: 18.5 u K R^3; the difference: 41 u K R^3
 *
 * For det, dot <= 2 R^2 and cross <= K R. So each product errs by
 *
 *     2 R^2 * 4.1 u K R + K R * 8.1 u R^2 + 2 u K R^3 < 18.5 u K R^3
 *
 * and the difference of both, which is rounded, by 41 u K R^3. */
#define DT_SCAN_CROSS_BOUND (8 * DT_U) /* of K R */
#define DT_SCAN_DOT_BOUND (12 * DT_U)  /* of R^2 */
#define DT_SCAN_DET_BOUND (48 * DT_U)  /* of K R^3 */

/* The cotangent s = dot / cross, where cross > 2^-24 K R, 2^26 times the bound of cross: it errs by
 * less than 2^-26 (1.5 R / K + |s|). So two of them that are 2^-24 (2 R / K + |s|) apart, s the
 * smaller one, are in the right order. */
#define DT_SCAN_SURE 0x1p-24

/* The remaining error of an upper bound of s, after the errors of dot and cross: a sum, a difference
 * and a quotient. */
#define DT_SCAN_COTANGENT_BOUND 0x1p-50 /* of |s|: 8 u > 4 u */

/* A circle segment over an edge of length L: size = L sqrt(1 + s^2), the diameter of its circle, is
 * no less than L and |s| L. Its centre, relative to a, and its radius err by less than 16 u of size:
 *
 *     d 1 u; L, a square root, 4 u; products and sums 3 u; sqrt(1 + s^2) 4 u, or 4 u in each of the
 *     two terms whose sum it is if it comes from a height
 *
 * The last sum, with a coordinate of a, adds up to 2 u of that coordinate. */
#define DT_SEGMENT_PAD 0x1p-47 /* of size: 64 u */

/* Whether the segment reaches as far as its circle in a direction is asked with more room than
 * that, since a box that is too large does no harm. So is its height, and R. */
#define DT_SEGMENT_ROOM 0x1p-40
#define DT_REACH_ROOM 0x1p-20

/* The strip along an edge, in cells: u and v of a, each product with the slope and each sum with
 * the number of a line or cell err by a few u of the terms |u| + (|v| + lines) |slope| + length. */
#define DT_STRIP_PAD 0x1p-47 /* of these terms: 64 u */

/* ---- the nearest point of the paper's grid (grid.c) ---- */

/* A coordinate in cells is below 2^29, there being less than 2^28 points and no more cells along an
 * axis than 1 for each. It errs by 3 u of itself, its distance from the border of a cell by u more:
 * 2^-22. A distance in units errs by 3 u, and its product with the cells of a unit by 2 u. */
#define DT_RING_ROOM 0x1p-20 /* cells, and of the distance in cells */
