/* constrained.cpp - compares constrained triangulations of the core with those of CGAL.
 *
 * constrained GRAPHS SIZE [SEED [FAMILY]]
 *
 * First random graphs on small lattices, where segments touch, overlap, run through points and dangle. Then random segments
 * that do not cross between SIZE points of every family, short ones and long ones. Each is compared as declared one by one
 * and after random edits. The set that the edits leave is also built at once by both engines, with one thread and two, and
 * with its constraints declared in another order. CGAL gets each part of a constraint between neighbouring points on it
 * once; these parts are found among all points, exactly. The last line counts the comparisons. */
#include <stdatomic.h>
extern "C" {
#include "core/delaunay_constraints.h"
#include "tests/core/threads.h"
#include "tests/oracle/families.h"
}

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <vector>

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using vertex_base = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, kernel>;
using face_base = CGAL::Constrained_triangulation_face_base_2<kernel>;
using data = CGAL::Triangulation_data_structure_2<vertex_base, face_base>;
using cdt = CGAL::Constrained_Delaunay_triangulation_2<kernel, data>;
using triangle = std::array<uint32_t, 3>;
using part = std::pair<uint32_t, uint32_t>;

static std::mt19937_64 random_bits;

static uint32_t below(uint32_t n)
{
    return static_cast<uint32_t>(random_bits() % n);
}

static void expect(bool ok, const char *what)
{
    if (!ok)
        throw std::runtime_error(what);
}

/* ---- a set ---- */

static std::map<uint32_t, kernel::Point_2> vertices_of(const dt *t)
{
    std::map<uint32_t, kernel::Point_2> vertices;
    for (uint32_t id = 0, rep; id < dt_next_id(t); id++) {
        dt_point p;
        if (dt_representative(t, id, &rep) == DT_OK && rep == id && dt_get(t, id, &p) == DT_OK)
            vertices.emplace(id, kernel::Point_2(p.x, p.y));
    }
    return vertices;
}

static std::vector<triangle> triangles_of(const dt *t)
{
    dt_cursor c;
    std::vector<triangle> rows;
    size_t have = 0, n, words;
    expect(dt_table_begin(t, nullptr, DT_TRIANGLES, false, &c) == DT_OK, "no triangles");
    rows.resize(c.rows + 3);
    do {
        dt_status s =
            dt_table_read(t, &c, rows[have].data(), 3 * (rows.size() - have), SIZE_MAX, &n, &words);
        expect(s == DT_OK || s == DT_TOOLONG, "triangles cannot be read");
        have += n;
        if (s == DT_TOOLONG)
            n = 1;
    } while (n > 0 && have < c.rows);
    rows.resize(have);
    return rows;
}

/* By a look at all points that are between the ends in the order of x, then y. */
static std::set<part> parts_of(const dt *t, const std::map<uint32_t, kernel::Point_2> &vertices)
{
    std::vector<std::pair<kernel::Point_2, uint32_t>> sorted;
    for (const auto &v : vertices)
        sorted.emplace_back(v.second, v.first);
    std::sort(sorted.begin(), sorted.end());
    std::set<part> parts;
    dt_constraint *c;
    size_t n;
    expect(dt_constraints(t, nullptr, DT_NONE, &c, &n) == DT_OK, "no constraints");
    for (size_t i = 0; i < n; i++) {
        uint32_t a, b;
        dt_representative(t, c[i].a, &a);
        dt_representative(t, c[i].b, &b);
        kernel::Point_2 p = std::min(vertices.at(a), vertices.at(b));
        kernel::Point_2 q = std::max(vertices.at(a), vertices.at(b));
        uint32_t before = DT_NONE;
        for (auto v = std::lower_bound(sorted.begin(), sorted.end(), std::make_pair(p, 0u));
             a != b && v != sorted.end() && v->first <= q; ++v) {
            if (!CGAL::collinear(p, v->first, q))
                continue;
            if (before != DT_NONE)
                parts.insert(std::minmax(before, v->second));
            before = v->second;
        }
    }
    free(c);
    return parts;
}

/* ---- the comparison ---- */

static std::vector<triangle> triangles_by_cgal(const std::map<uint32_t, kernel::Point_2> &vertices,
                                               const std::set<part> &parts)
{
    cdt d;
    std::map<uint32_t, cdt::Vertex_handle> handle;
    std::vector<std::pair<kernel::Point_2, uint32_t>> points;
    for (const auto &v : vertices)
        points.emplace_back(v.second, v.first);
    d.insert(points.begin(), points.end());
    for (auto v = d.finite_vertices_begin(); v != d.finite_vertices_end(); ++v)
        handle[v->info()] = v;
    for (const part &p : parts)
        d.insert_constraint(handle.at(p.first), handle.at(p.second));
    std::vector<triangle> rows;
    for (auto f = d.finite_faces_begin(); d.dimension() == 2 && f != d.finite_faces_end(); ++f) {
        triangle row = {f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()};
        std::rotate(row.begin(), std::min_element(row.begin(), row.end()), row.end());
        rows.push_back(row);
    }
    std::sort(rows.begin(), rows.end());
    return rows;
}

static void compare(const dt *t)
{
    const char *fault = "";
    if (dt_check(t, nullptr, &fault) != DT_OK)
        throw std::runtime_error(fault);
    auto vertices = vertices_of(t);
    expect(triangles_of(t) == triangles_by_cgal(vertices, parts_of(t, vertices)),
           "triangles differ from CGAL's");
}

/* ---- other histories ---- */

/* The same points and constraints, triangulated afterwards. */
static dt *built_at_once(const dt *t, dt_method method, unsigned threads)
{
    dt *copy;
    dt_options opt = {};
    dt_pool pool = threads_pool(threads);
    opt.method = method;
    opt.pool = &pool;
    expect(dt_clone_points(t, nullptr, &copy) == DT_OK, "no copy");
    expect(dt_triangulate(copy, &opt) == DT_OK, "no triangulation of a copy");
    return copy;
}

/* The same points, and the constraints in random order and direction after the triangulation. */
static dt *declared_again(const dt *t)
{
    dt_constraint *c;
    size_t n, released, added, at;
    uint32_t missing;
    dt *copy = built_at_once(t, DT_AUTO, 1);
    expect(dt_constraints(t, nullptr, DT_NONE, &c, &n) == DT_OK &&
               dt_release(copy, c, n, nullptr, &released, &at) == DT_OK && released == n,
           "constraints of a copy cannot be released");
    std::shuffle(c, c + n, random_bits);
    for (size_t i = 0; i < n; i += 2)
        std::swap(c[i].a, c[i].b);
    expect(dt_constrain(copy, c, n, nullptr, &added, &missing) == DT_OK && added == n,
           "constraints are refused in another order");
    free(c);
    return copy;
}

static void compare_histories(const dt *t)
{
    dt *other[] = {built_at_once(t, DT_DIVIDE, 1), built_at_once(t, DT_DIVIDE, 2),
                   built_at_once(t, DT_SHELLING, 1), declared_again(t)};
    auto rows = triangles_of(t);
    for (dt *o : other) {
        expect(triangles_of(o) == rows, "a build differs from its history");
        dt_free(o);
    }
}

/* ---- graphs ---- */

static dt_point lattice_place(uint32_t width, uint32_t height)
{
    return {static_cast<double>(below(width)), static_cast<double>(below(height))};
}

/* A random live id. */
static uint32_t live_id(const dt *t)
{
    dt_point p;
    for (;;) {
        uint32_t id = below(dt_next_id(t));
        if (dt_get(t, id, &p) == DT_OK)
            return id;
    }
}

static void constrain(dt *t, uint32_t a, uint32_t b)
{
    dt_constraint c = {a, b, below(2) == 0, below(3)};
    size_t added;
    uint32_t missing;
    if (c.a != c.b) {
        dt_status s = dt_constrain(t, &c, 1, nullptr, &added, &missing);
        expect(s == DT_OK || s == DT_CROSSES, "a constraint is refused");
    }
}

static void edit(dt *t, uint32_t width, uint32_t height)
{
    dt_added added;
    struct dt_summary sum;
    uint32_t id = live_id(t), n;
    dt_point to = lattice_place(width, height);
    dt_status s = DT_OK;
    dt_summary(t, &sum);
    switch (sum.points < 3 ? 0 : below(5)) {
    case 0:
        s = dt_add(t, &to, 1, &added);
        break;
    case 1:
        s = dt_delete(t, &id, 1, &n, &id);
        break;
    case 2:
        s = dt_move(t, id, to);
        break;
    case 3:
        s = dt_delete_cascade(t, &id, 1, nullptr, &n, &id);
        break;
    default:
        constrain(t, live_id(t), live_id(t));
    }
    expect(s == DT_OK || s == DT_CROSSES || s == DT_CONSTRAINED, "an edit fails");
}

static size_t compare_graph()
{
    uint32_t width = 2 + below(9), height = 2 + below(9), n = 4 + below(width * height);
    std::vector<dt_point> p;
    for (uint32_t i = 0; i < n; i++)
        p.push_back(lattice_place(width, height));
    dt *t = dt_new(0);
    dt_added added;
    expect(dt_add(t, p.data(), n, &added) == DT_OK && dt_triangulate(t, nullptr) == DT_OK,
           "no set");
    for (uint32_t i = below(2 * n); i > 0; i--)
        constrain(t, live_id(t), live_id(t));
    compare(t);
    for (uint32_t i = below(20); i > 0; i--)
        edit(t, width, height);
    compare(t);
    compare_histories(t);
    dt_free(t);
    return 2;
}

/* ---- families ---- */

/* A random point at most `most` edges from id, or id. */
static uint32_t near_id(const dt *t, uint32_t id, uint32_t most)
{
    dt_ids ring = {nullptr, 0, 0};
    uint32_t representative;
    bool boundary;
    for (uint32_t i = below(most + 1); i > 0; i--) {
        ring.n = 0;
        expect(dt_ring(t, id, false, &ring, &representative, &boundary) == DT_OK, "no ring");
        if (ring.n > 0)
            id = ring.v[below(static_cast<uint32_t>(ring.n))];
    }
    free(ring.v);
    return id;
}

static size_t compare_family(const family &f, uint32_t n, uint64_t seed)
{
    std::vector<dt_point> p(n);
    family_points(&f, p.data(), n, seed);
    dt *t = dt_new(0);
    dt_added added;
    expect(dt_add(t, p.data(), n, &added) == DT_OK && dt_triangulate(t, nullptr) == DT_OK,
           "no set");
    for (uint32_t i = n > 10000 ? 10 : 100; i > 0; i--)
        constrain(t, live_id(t), live_id(t));
    for (uint32_t i = std::min(n / 10, 2000u); i > 0; i--) {
        uint32_t id = live_id(t);
        constrain(t, id, near_id(t, id, 8));
    }
    compare(t);
    for (uint32_t i = 0; i < 200; i++)
        edit(t, 3, 3);
    compare(t);
    compare_histories(t);
    dt_free(t);
    return 2;
}

int main(int argc, char **argv)
{
    if (argc < 3)
        return 2;
    uint64_t seed = argc > 3 ? strtoull(argv[3], nullptr, 10) : 1;
    size_t compared = 0;
    const char *what = "a graph";
    try {
        for (int i = 0, n = atoi(argv[1]); i < n; i++) {
            random_bits.seed(seed + static_cast<uint64_t>(i));
            compared += compare_graph();
        }
        for (const family *f = families; f->name != nullptr; f++) {
            if (argc > 4 && strcmp(argv[4], f->name) != 0)
                continue;
            what = f->name;
            random_bits.seed(seed);
            compared += compare_family(*f, static_cast<uint32_t>(atoi(argv[2])), seed);
        }
    } catch (const std::exception &e) {
        fprintf(stderr, "constrained: %s, after %zu comparisons with seed %llu: %s\n", what,
                compared, static_cast<unsigned long long>(seed), e.what());
        return 1;
    }
    printf("constrained: %zu triangulations equal CGAL's\n", compared);
    return 0;
}
