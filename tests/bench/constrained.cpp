/* constrained.cpp - constraints beside CGAL, in processor time of one thread.
 *
 *     constrained POINTS LONG_POINTS LONG
 *
 * First POINTS random points in rows of about a thousand, with constraints along the rows; ids are in random order. Then LONG
 * constraints across all of LONG_POINTS random points. Both programs get the same; the best of three runs that alternate.
 *
 * Then edits of the core's sets of LONG_POINTS points: with a constraint for every third point, to a neighbour, and without
 * constraints. ns for one, the best of three. Moves go a tenth of the mean distance between points, or six
 * tenths; those that constraints refuse are left out. NEAREST looks up random places. Then the bytes that each of these
 * constraints takes.
 *
 * Then constraints that cross about k edges, each declared in a set that has but one other, and released: ns beside the
 * 2,000 + 150 k that they may take. Among random points a segment crosses 2.16 edges on each mean distance between points. */
#include <stdatomic.h>
extern "C" {
#include "core/delaunay_constraints.h"
}

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numeric>
#include <random>
#include <vector>

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using vertex_base = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, kernel>;
using face_base = CGAL::Constrained_triangulation_face_base_2<kernel>;
using data = CGAL::Triangulation_data_structure_2<vertex_base, face_base>;
using cdt = CGAL::Constrained_Delaunay_triangulation_2<kernel, data>;

/* As in a daemon, memory that has been used once is used again; CGAL's comes from malloc, which does the same. */
static dt_pages *pages;

struct job {
    std::vector<dt_point> points;
    std::vector<dt_constraint> constraints;
};

static double seconds()
{
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/* In s[2]: all, and the constraints. */
static void run_core(const job &j, double s[2])
{
    dt_added added;
    size_t n;
    uint32_t missing;
    dt *t = dt_new_in(0, pages);
    double start = seconds();
    if (dt_add(t, j.points.data(), j.points.size(), &added) != DT_OK ||
        dt_triangulate(t, nullptr) != DT_OK)
        exit(1);
    double built = seconds();
    if (dt_constrain(t, j.constraints.data(), j.constraints.size(), nullptr, &n, &missing) != DT_OK)
        exit(1);
    double end = seconds();
    s[0] = std::min(s[0], end - start);
    s[1] = std::min(s[1], end - built);
    dt_free(t);
}

/* Constraints that are known before the triangulation. */
static void run_bulk(const job &j, double s[2])
{
    dt_added added;
    size_t n;
    uint32_t missing;
    dt *t = dt_new_in(0, pages);
    double start = seconds();
    if (dt_add(t, j.points.data(), j.points.size(), &added) != DT_OK ||
        dt_constrain(t, j.constraints.data(), j.constraints.size(), nullptr, &n, &missing) != DT_OK)
        exit(1);
    double declared = seconds();
    if (dt_triangulate(t, nullptr) != DT_OK)
        exit(1);
    double end = seconds();
    s[0] = std::min(s[0], end - start);
    s[1] = std::min(s[1], declared - start);
    dt_free(t);
}

static void run_cgal(const job &j, double s[2])
{
    double start = seconds();
    cdt d;
    std::vector<std::pair<kernel::Point_2, uint32_t>> points;
    std::vector<cdt::Vertex_handle> handle(j.points.size());
    for (uint32_t i = 0; i < j.points.size(); i++)
        points.emplace_back(kernel::Point_2(j.points[i].x, j.points[i].y), i);
    d.insert(points.begin(), points.end());
    for (auto v = d.finite_vertices_begin(); v != d.finite_vertices_end(); ++v)
        handle[v->info()] = v;
    double built = seconds();
    for (const dt_constraint &c : j.constraints)
        d.insert_constraint(handle[c.a], handle[c.b]);
    double end = seconds();
    s[0] = std::min(s[0], end - start);
    s[1] = std::min(s[1], end - built);
}

static job random_points(size_t n)
{
    job j;
    std::mt19937_64 bits(1);
    std::uniform_real_distribution<double> unit;
    for (size_t i = 0; i < n; i++)
        j.points.push_back({unit(bits), unit(bits)});
    return j;
}

/* Along rows of about a thousand points each. */
static job paths(size_t n)
{
    job j = random_points(n);
    std::vector<uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0);
    double rows = std::max(1.0, static_cast<double>(n) / 1000);
    auto row = [&](uint32_t i) { return static_cast<long>(j.points[i].y * rows); };
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        return row(a) != row(b) ? row(a) < row(b) : j.points[a].x < j.points[b].x;
    });
    for (size_t i = 1; i < n; i++)
        if (row(order[i - 1]) == row(order[i]))
            j.constraints.push_back({order[i - 1], order[i], false, 0});
    return j;
}

/* One in each of `most` strips: from its leftmost point to its rightmost. */
static job across(size_t n, size_t most)
{
    job j = random_points(n);
    std::vector<uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return j.points[a].y < j.points[b].y; });
    for (size_t i = 0; i < most; i++) {
        auto from = order.begin() + static_cast<long>(i * n / most),
             to = order.begin() + static_cast<long>((i + 1) * n / most);
        auto by_x = [&](uint32_t a, uint32_t b) { return j.points[a].x < j.points[b].x; };
        j.constraints.push_back(
            {*std::min_element(from, to, by_x), *std::max_element(from, to, by_x), false, 0});
    }
    return j;
}

static void measure(const char *name, const job &j)
{
    double core[2] = {1e9, 1e9}, bulk[2] = {1e9, 1e9}, cgal[2] = {1e9, 1e9};
    for (int i = 0; i < 3; i++) {
        run_core(j, core);
        run_bulk(j, bulk);
        run_cgal(j, cgal);
    }
    printf("%-10s points %8zu constraints %7zu  CGAL %.3f s (constraints %.3f)  core %.3f (%.3f) = "
           "%.2f  bulk %.3f = %.2f\n",
           name, j.points.size(), j.constraints.size(), cgal[0], cgal[1], core[0], core[1],
           core[0] / cgal[0], bulk[0], bulk[0] / cgal[0]);
}

/* ---- live ---- */

enum { MOVE_NEAR, MOVE_FAR, NEAREST, ADD, DELETE, EDITS };

static std::vector<dt_constraint> to_neighbours(const dt *t, size_t n)
{
    std::vector<dt_constraint> c;
    dt_ids ring = {nullptr, 0, 0};
    uint32_t representative;
    bool boundary;
    for (uint32_t i = 0; i < n; i += 3) {
        ring.n = 0;
        if (dt_ring(t, i, false, &ring, &representative, &boundary) != DT_OK)
            exit(1);
        c.push_back({i, ring.v[i / 3 % ring.n], false, 0});
    }
    free(ring.v);
    return c;
}

struct move {
    uint32_t id;
    dt_point to;
};

/* Moves random points of t by up to half of `step`. Returns those moves that are not refused. */
static std::vector<move> try_moves(dt *t, size_t n, double step)
{
    std::mt19937_64 bits(2);
    std::uniform_real_distribution<double> offset(-step / 2, step / 2);
    std::vector<move> done;
    for (size_t i = 0; i < n / 5; i++) {
        uint32_t id = static_cast<uint32_t>(bits() % n);
        dt_point p;
        dt_get(t, id, &p);
        p.x += offset(bits);
        p.y += offset(bits);
        if (dt_move(t, id, p) == DT_OK)
            done.push_back({id, p});
    }
    return done;
}

static dt *live_set(const job &j)
{
    size_t count;
    dt_added added;
    uint32_t missing;
    dt *t = dt_new_in(0, pages);
    if (dt_add(t, j.points.data(), j.points.size(), &added) != DT_OK ||
        dt_triangulate(t, nullptr) != DT_OK || dt_prepare(t, nullptr) != DT_OK ||
        dt_constrain(t, j.constraints.data(), j.constraints.size(), nullptr, &count, &missing) !=
            DT_OK)
        exit(1);
    return t;
}

/* Best of itself and the ns since `start`, for each of n edits; *start becomes now. */
static void note(double &ns, double &start, size_t n)
{
    double now = seconds();
    ns = std::min(ns, 1e9 * (now - start) / static_cast<double>(n));
    start = now;
}

static void edit_live(const job &j, const std::vector<move> moves[2], double ns[EDITS])
{
    size_t n = j.points.size();
    dt_added added;
    uint32_t missing, deleted;
    dt *t = live_set(j);
    job more = random_points(n + n / 5);
    double start = seconds();
    for (int far = 0; far < 2; far++) {
        for (const move &m : moves[far])
            dt_move(t, m.id, m.to);
        note(ns[far ? MOVE_FAR : MOVE_NEAR], start, moves[far].size());
    }
    dt_ids out = {nullptr, 0, 0};
    for (size_t i = n; i < n + n / 5; i++, out.n = 0)
        dt_nearest(t, more.points[i], 1, &out);
    note(ns[NEAREST], start, n / 5);
    free(out.v);
    for (size_t i = n; i < n + n / 5; i++)
        dt_add(t, &more.points[i], 1, &added);
    note(ns[ADD], start, n / 5);
    for (uint32_t id = static_cast<uint32_t>(n); id < n + n / 5; id++)
        dt_delete(t, &id, 1, &deleted, &missing);
    note(ns[DELETE], start, n / 5);
    dt_free(t);
}

static void measure_memory(const job &without, const job &with)
{
    size_t bytes[2];
    for (int i = 0; i < 2; i++) {
        struct dt_summary sum;
        dt *t = live_set(i == 0 ? without : with);
        dt_summary(t, &sum);
        bytes[i] = sum.memory;
        dt_free(t);
    }
    printf("memory     %.1f bytes for each of %zu constraints\n",
           static_cast<double>(bytes[1] - bytes[0]) / static_cast<double>(with.constraints.size()),
           with.constraints.size());
}

static void measure_live(const job &without)
{
    static const char *const name[] = {"MOVE near", "MOVE far", "NEAREST", "ADD", "DEL"};
    double ns[2][EDITS];
    std::fill(&ns[0][0], &ns[0][0] + 2 * EDITS, 1e9);
    size_t n = without.points.size();
    double apart = 1 / std::sqrt(static_cast<double>(n));
    job with = without;
    dt *t = live_set(without);
    with.constraints = to_neighbours(t, n);
    dt_free(t);
    t = live_set(with);
    const std::vector<move> moves[2] = {try_moves(t, n, apart / 10),
                                        try_moves(t, n, apart * 6 / 10)};
    dt_free(t);
    for (int i = 0; i < 3; i++) {
        edit_live(without, moves, ns[0]);
        edit_live(with, moves, ns[1]);
    }
    for (int i = 0; i < EDITS; i++)
        printf("%-10s points %8zu  without constraints %.0f ns  with %.0f = %.2f\n", name[i], n,
               ns[0][i], ns[1][i], ns[1][i] / ns[0][i]);
    measure_memory(without, with);
}

/* ---- crossing k edges ---- */

/* From random points, to the nearest ones of places as far away as crosses k edges. */
static std::vector<dt_constraint> crossing(const dt *t, size_t n, double k)
{
    std::mt19937_64 bits(3);
    std::uniform_real_distribution<double> turn(0, 2 * std::acos(-1));
    double length = k / 2.16 / std::sqrt(static_cast<double>(n));
    std::vector<dt_constraint> c;
    dt_ids out = {nullptr, 0, 0};
    while (c.size() < 2000) {
        uint32_t a = static_cast<uint32_t>(bits() % n);
        double angle = turn(bits);
        dt_point p;
        dt_get(t, a, &p);
        p.x += length * std::cos(angle);
        p.y += length * std::sin(angle);
        out.n = 0;
        if (p.x > 0 && p.x < 1 && p.y > 0 && p.y < 1 && dt_nearest(t, p, 1, &out) == DT_OK &&
            out.v[0] != a)
            c.push_back({a, out.v[0], false, 0});
    }
    free(out.v);
    return c;
}

static void measure_crossing(job j, double k)
{
    dt *t = live_set(j);
    j.constraints = to_neighbours(t, 1); /* the first one marks all triangles */
    dt_free(t);
    t = live_set(j);
    double ns[2] = {1e9, 1e9};
    for (int i = 0; i < 3; i++) {
        double both[2] = {0, 0};
        std::vector<dt_constraint> c = crossing(t, j.points.size(), k);
        for (const dt_constraint &one : c) {
            size_t count, at;
            uint32_t missing;
            double start = seconds();
            if (dt_constrain(t, &one, 1, nullptr, &count, &missing) != DT_OK)
                continue;
            double declared = seconds();
            if (dt_release(t, &one, 1, nullptr, &count, &at) != DT_OK)
                exit(1);
            both[0] += declared - start;
            both[1] += seconds() - declared;
        }
        for (int b = 0; b < 2; b++)
            ns[b] = std::min(ns[b], 1e9 * both[b] / static_cast<double>(c.size()));
    }
    printf("crossing %6.0f edges: declared %.0f ns, released %.0f, both / (2000 + 150 k) = %.2f\n",
           k, ns[0], ns[1], (ns[0] + ns[1]) / (2000 + 150 * k));
    dt_free(t);
}

int main(int argc, char **argv)
{
    if (argc < 4)
        return 2;
    pages = dt_pages_new(SIZE_MAX);
    measure("paths", paths(strtoull(argv[1], nullptr, 10)));
    measure("across", across(strtoull(argv[2], nullptr, 10), strtoull(argv[3], nullptr, 10)));
    measure_live(random_points(strtoull(argv[2], nullptr, 10)));
    for (double k : {1, 10, 100, 1000})
        measure_crossing(random_points(strtoull(argv[2], nullptr, 10)), k);
    dt_pages_free(pages);
    return 0;
}
