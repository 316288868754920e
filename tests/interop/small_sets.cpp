/* small_sets.cpp - very many very small sets, through the core's header: tables, both engines and edits
 * compared with CGAL. Most errors in geometry show up with few points on a small lattice.
 *
 *     small_sets [SETS [SEED]]        prints the first set that fails */
#include "tests/interop/daemon.h"

#include <stdatomic.h> /* C++23 has it, but not inside of extern "C" */
extern "C" {
#include "core/delaunay.h"
}

#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>

static std::mt19937_64 source;

static size_t below(size_t n)
{
    return source() % n;
}

/* Lattice points, scaled and shifted so that some lattices are exact and others are rounded. */
struct lattice {
    size_t columns, rows;
    double scale, shift;

    lattice()
    {
        static const double scales[] = {1, 0.1, 1.0 / 3, 0x1p-52, 0x1p-142, 0x1p195, 1e-9};
        size_t kind = below(7);
        columns = 1 + below(below(2) == 0 ? 3 : 9);
        rows = 1 + below(below(3) == 0 ? 2 : 9);
        scale = scales[kind];
        shift = kind == 3 ? 1 : kind == 6 ? 1e3 : below(3) == 0 ? -4 * scale : 0;
    }

    dt_point point() const
    {
        double x = static_cast<double>(below(columns)), y = static_cast<double>(below(rows));
        return {x * scale + shift, y * scale + shift};
    }
};

static oracle_rows read_table(const dt *t, dt_table table, bool cw)
{
    dt_cursor c;
    oracle_rows rows;
    uint32_t words[4096];
    size_t got, used;
    if (dt_table_begin(t, NULL, table, cw, &c) != DT_OK)
        throw failure("dt_table_begin");
    while (dt_table_read(t, &c, words, 4096, 1, &got, &used) == DT_OK && got == 1) {
        rows.emplace_back(words, words + used);
        if (table == DT_LISTS)
            rows.back().erase(rows.back().begin() + 1); /* the degree */
    }
    return rows;
}

static void expect(const char *what, const oracle_rows &got, const oracle_rows &want)
{
    if (got == want)
        return;
    std::string text = what;
    for (const auto &row : got)
        text += "\n  got  " + row_text(row);
    for (const auto &row : want)
        text += "\n  want " + row_text(row);
    throw failure(text);
}

static void compare(const dt *t, const std::map<uint32_t, dt_point> &live, bool cw)
{
    std::vector<oracle_point> points;
    for (const auto &[id, p] : live)
        points.push_back({id, p.x, p.y});
    cgal_delaunay oracle(points);
    const char *fault = "";
    if (dt_check(t, nullptr, &fault) != DT_OK)
        throw failure(std::string("dt_check: ") + fault);
    expect("triangles", read_table(t, DT_TRIANGLES, cw), oracle.triangles(cw));
    expect("lists", read_table(t, DT_LISTS, cw), oracle.lists(cw));
    expect("edges", read_table(t, DT_EDGES, false), oracle.edges());
    expect("coincident", read_table(t, DT_COINCIDENT, false), oracle.coincident());
}

static void must(dt_status status, const char *what)
{
    if (status != DT_OK)
        throw failure(std::string(what) + ": status " + std::to_string(status));
}

static void triangulate(dt *t, dt_method method)
{
    dt_options opt = {};
    opt.method = method;
    must(dt_triangulate(t, &opt), "dt_triangulate");
}

static void edit(dt *t, const lattice &l, std::map<uint32_t, dt_point> &live)
{
    dt_point p = l.point();
    dt_added added;
    uint32_t id = live.empty()
                      ? 0
                      : std::next(live.begin(), static_cast<ptrdiff_t>(below(live.size())))->first;
    size_t kind = live.empty() ? 0 : below(3);
    if (kind == 0) {
        must(dt_add(t, &p, 1, &added), "dt_add");
        live[added.first] = p;
    } else if (kind == 1) {
        uint32_t deleted, missing;
        must(dt_delete(t, &id, 1, &deleted, &missing), "dt_delete");
        live.erase(id);
    } else {
        must(dt_move(t, id, p), "dt_move");
        live[id] = p;
    }
}

static void try_set(dt *t, const lattice &l, std::map<uint32_t, dt_point> &live)
{
    std::vector<dt_point> points(below(4) == 0 ? below(60) : below(12));
    dt_added added;
    for (size_t i = 0; i < points.size(); i++)
        live[static_cast<uint32_t>(i)] = points[i] = l.point();
    must(dt_add(t, points.data(), points.size(), &added), "dt_add");
    for (dt_method method : {DT_DIVIDE, DT_SHELLING}) {
        triangulate(t, method);
        compare(t, live, method == DT_SHELLING);
    }
    for (size_t i = below(10) == 0 ? 50 : 4; i > 0; i--) {
        for (size_t k = below(4); k > 0; k--)
            edit(t, l, live);
        must(dt_refresh(t, nullptr), "dt_refresh");
        compare(t, live, false);
    }
}

/* ---- a tolerance above zero: the nearest earlier representative within reach, by brute force ----
 */

/* The index in reps of the one that p coincides with; reps.size() if none does. On eighths, all of
 * this is exact. */
static size_t coincides(const std::vector<oracle_point> &reps, dt_point p, double tol)
{
    size_t best = reps.size();
    double least = tol * tol;
    for (size_t i = 0; i < reps.size(); i++) {
        double dx = p.x - reps[i].x, dy = p.y - reps[i].y, square = dx * dx + dy * dy;
        if (square < least || (square == least && best == reps.size())) {
            least = square;
            best = i;
        }
    }
    return best;
}

static void try_tolerance(dt *t)
{
    std::vector<dt_point> points(below(40));
    std::vector<oracle_point> reps;
    oracle_rows coincident;
    dt_added added;
    for (size_t i = 0; i < points.size(); i++) {
        points[i] = {static_cast<double>(below(20)) / 8, static_cast<double>(below(9)) / 8 - 0.5};
        size_t at = coincides(reps, points[i], dt_tolerance(t));
        uint32_t id = static_cast<uint32_t>(i);
        if (at < reps.size())
            coincident.push_back({id, reps[at].id});
        else
            reps.push_back({id, points[i].x, points[i].y});
    }
    must(dt_add(t, points.data(), points.size(), &added), "dt_add");
    triangulate(t, DT_AUTO);
    expect("coincident", read_table(t, DT_COINCIDENT, false), coincident);
    expect("triangles", read_table(t, DT_TRIANGLES, false), cgal_delaunay(reps).triangles(false));
}

int main(int argc, char **argv)
{
    size_t sets = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 20000;
    uint64_t seed = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 1;
    for (size_t i = 0; i < sets; i++) {
        source.seed(seed + i);
        lattice l;
        bool tolerant = below(8) == 0;
        dt *t = dt_new(tolerant ? static_cast<double>(1 + below(4)) / 8 : 0);
        std::map<uint32_t, dt_point> live;
        try {
            if (tolerant)
                try_tolerance(t);
            else
                try_set(t, l, live);
        } catch (const failure &e) {
            std::printf("FAIL small_sets 1 %zu: %s\n", seed + i, e.what());
            for (const auto &[id, p] : live)
                std::printf("%u %a %a\n", id, p.x, p.y);
            return 1;
        }
        dt_free(t);
    }
    return 0;
}
