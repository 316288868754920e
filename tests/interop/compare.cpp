/* compare.cpp - compares the replies of a running daemon with the results of CGAL.
 *
 *     compare PORT [SHARD SHARDS] [FAMILY]
 *
 * A job is a family, a size and a seed. It loads the points, triangulates with each engine, compares whole
 * tables byte for byte, sends queries for random places, then edits at random and compares again with a
 * fresh triangulation by CGAL. The last line counts the jobs. */
#include "tests/interop/daemon.h"

#include <stdatomic.h> /* C++23 has it, but not inside of extern "C" */
extern "C" {
#include "tests/oracle/families.h"
}

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <random>

struct job {
    daemon_link &daemon;
    const family &kind;
    size_t n;
    unsigned seed;
    std::string set;
    std::mt19937_64 random;
    std::map<uint32_t, oracle_point> live;
    uint32_t next_id;

    size_t below(size_t limit)
    {
        return random() % limit;
    }
};

static bool in_range(double v)
{
    return v == 0 || (std::fabs(v) >= 0x1p-142 && std::fabs(v) <= 0x1p201);
}

static std::string difference(const std::string &what, const std::string &got,
                              const std::string &want)
{
    return what + "\n  got  " + got + "\n  want " + want;
}

static void expect(bool ok, const std::string &what, const std::string &got,
                   const std::string &want)
{
    if (!ok)
        throw failure(difference(what, got, want));
}

static void expect_text(const std::string &what, const std::string &got, const std::string &want)
{
    expect(got == want, what, got, want);
}

static std::string counts_text(const cgal_delaunay &oracle)
{
    size_t aliases = oracle.coincident().size();
    return "points=" + std::to_string(oracle.points().size() + aliases) +
           " coincident=" + std::to_string(aliases) +
           " triangles=" + std::to_string(oracle.triangles(false).size()) +
           " edges=" + std::to_string(oracle.edges().size()) +
           " hull=" + std::to_string(oracle.hull(false).size());
}

static cgal_delaunay fresh_oracle(const job &j)
{
    std::vector<oracle_point> points;
    for (const auto &entry : j.live)
        points.push_back(entry.second);
    return cgal_delaunay(points);
}

/* ---- replies against rows ---- */

static void expect_rows(job &j, const std::string &request, const std::string &extra,
                        const oracle_rows &rows)
{
    reply r = j.daemon.ask(request);
    expect_text(request, r.status, "OK " + std::to_string(rows.size()) + extra);
    for (size_t i = 0; i < rows.size(); i++) {
        std::string want = row_text(rows[i]);
        if (r.lines[i] != want)
            throw failure(difference(request + ", line " + std::to_string(i), r.lines[i], want));
    }
}

static std::string id_and_place(const oracle_point &p)
{
    return std::to_string(p.id) + " " + number_text(p.x) + " " + number_text(p.y);
}

/* Lines `id x y` or `id x y distance`, seen from (x, y). */
static void expect_points(job &j, const std::string &request, const oracle_row &ids,
                          const double *from)
{
    reply r = j.daemon.ask(request);
    expect(r.status == "OK " + std::to_string(ids.size()), request, r.status, row_text(ids));
    for (size_t i = 0; i < ids.size(); i++) {
        const oracle_point &p = j.live.at(ids[i]);
        char id[16], x[64], y[64], distance[64], end;
        int words =
            std::sscanf(r.lines[i].c_str(), "%15s %63s %63s %63s %c", id, x, y, distance, &end);
        bool ok = words == (from ? 4 : 3) && id == std::to_string(p.id) && is_number(x, p.x) &&
                  is_number(y, p.y);
        if (ok && from)
            ok = is_number(distance, std::sqrt((p.x - from[0]) * (p.x - from[0]) +
                                               (p.y - from[1]) * (p.y - from[1])));
        if (!ok)
            throw failure(
                difference(request + ", line " + std::to_string(i), r.lines[i], id_and_place(p)));
    }
}

static oracle_row all_ids(const job &j)
{
    oracle_row ids;
    for (const auto &entry : j.live)
        ids.push_back(entry.first);
    return ids;
}

static void check_tables(job &j, const cgal_delaunay &oracle, bool cw)
{
    std::string turn = cw ? " CW" : "";
    std::string ends = " interior=" + std::to_string(oracle.interior()) +
                       " boundary=" + std::to_string(oracle.points().size() - oracle.interior());
    expect_rows(j, "TRIANGLES " + j.set + turn, "", oracle.triangles(cw));
    expect_rows(j, "LISTS " + j.set + turn, ends, oracle.lists(cw));
    expect_points(j, "HULL " + j.set + turn, oracle.hull(cw), nullptr);
    expect_rows(j, "EDGES " + j.set, "", oracle.edges());
    expect_rows(j, "COINCIDENT " + j.set, "", oracle.coincident());
    expect_points(j, "POINTS " + j.set, all_ids(j), nullptr);
    reply r = j.daemon.ask("CHECK " + j.set);
    expect(r.status.compare(0, 17, "OK 0 delaunay=yes") == 0, "CHECK", r.status,
           "OK 0 delaunay=yes");
}

/* ---- queries ---- */

/* Near the points, on them, between them, and outside. */
static bool random_place(job &j, const cgal_delaunay &oracle, double *q)
{
    const auto &points = oracle.points();
    if (points.empty())
        return false;
    const oracle_point &u = points[j.below(points.size())], &v = points[j.below(points.size())];
    double t = j.below(3) == 0   ? 0
               : j.below(2) == 0 ? 0.5
                                 : static_cast<double>(j.below(400)) / 200 - 0.5;
    double s = j.below(2) == 0 ? t : static_cast<double>(j.below(400)) / 200 - 0.5;
    q[0] = u.x + t * (v.x - u.x);
    q[1] = u.y + s * (v.y - u.y);
    return in_range(q[0]) && in_range(q[1]);
}

static void check_places(job &j, const cgal_delaunay &oracle)
{
    static const char *const where[] = {"outside", "vertex", "edge", "inside"};
    double q[2];
    for (int i = 0; i < 12; i++) {
        if (!random_place(j, oracle, q))
            continue;
        std::string at = j.set + " " + number_text(q[0]) + " " + number_text(q[1]);
        oracle_row found = oracle.locate(q[0], q[1]);
        expect_rows(j, "LOCATE " + at, std::string(" where=") + where[found.size()],
                    found.empty() ? oracle_rows{} : oracle_rows{found});
        expect_points(j, "NEAREST " + at, oracle.nearest(q[0], q[1], 1), q);
        size_t k = 1 + j.below(12);
        expect_points(j, "NEAREST " + at + " " + std::to_string(k), oracle.nearest(q[0], q[1], k),
                      q);
    }
}

/* The triangle of LOCATEB: among the triangles that contain the result of LOCATE, the first in TRIANGLES. */
static oracle_row triangle_of(const cgal_delaunay &oracle, const oracle_row &found)
{
    oracle_rows all;
    if (found.size() == 3)
        return found;
    if (found.size() == 2)
        all = {oracle.left_of(found[0], found[1]), oracle.left_of(found[1], found[0])};
    if (found.size() == 1)
        all = oracle.around(found[0]);
    oracle_row first(3, UINT32_MAX);
    for (const oracle_row &row : all)
        if (row.size() == 3)
            first = std::min(first, from_smallest(row));
    return first;
}

static void expect_words(const std::string &request, const oracle_row &got, const oracle_row &want)
{
    expect(got == want, request, row_text(got), row_text(want));
}

static void check_many_places(job &j, const cgal_delaunay &oracle)
{
    std::vector<double> xy;
    oracle_row triangles, nearest;
    size_t k = 1 + j.below(6);
    double q[2];
    for (size_t i = 0, n = j.below(100); i < n; i++) {
        if (!random_place(j, oracle, q))
            continue;
        xy.insert(xy.end(), q, q + 2);
        oracle_row row = triangle_of(oracle, oracle.locate(q[0], q[1]));
        triangles.insert(triangles.end(), row.begin(), row.end());
        row = oracle.nearest(q[0], q[1], k);
        row.resize(k, UINT32_MAX);
        nearest.insert(nearest.end(), row.begin(), row.end());
    }
    std::string at = j.set + " " + std::to_string(xy.size() / 2);
    expect_words("LOCATEB " + at, j.daemon.ask_places("LOCATEB " + at, xy), triangles);
    at += " " + std::to_string(k);
    expect_words("NEARESTB " + at, j.daemon.ask_places("NEARESTB " + at, xy), nearest);
}

static void check_ranges(job &j, const cgal_delaunay &oracle)
{
    double p[2], q[2];
    for (int i = 0; i < 4; i++) {
        if (!random_place(j, oracle, p) || !random_place(j, oracle, q))
            continue;
        double x0 = std::min(p[0], q[0]), x1 = std::max(p[0], q[0]);
        double y0 = std::min(p[1], q[1]), y1 = std::max(p[1], q[1]);
        expect_points(j,
                      "WITHIN " + j.set + " " + number_text(x0) + " " + number_text(y0) + " " +
                          number_text(x1) + " " + number_text(y1),
                      oracle.within_box(x0, y0, x1, y1), nullptr);
        double r = std::hypot(p[0] - q[0], p[1] - q[1]);
        if (in_range(r))
            expect_points(j,
                          "WITHIN " + j.set + " " + number_text(p[0]) + " " + number_text(p[1]) +
                              " " + number_text(r),
                          oracle.within_disc(p[0], p[1], r), nullptr);
    }
}

/* The triangles left of the given directed edges, those that exist. */
static oracle_rows left_of(const cgal_delaunay &oracle,
                           std::initializer_list<std::pair<uint32_t, uint32_t>> edges)
{
    oracle_rows rows;
    for (auto [a, b] : edges) {
        oracle_row row = oracle.left_of(a, b);
        if (!row.empty())
            rows.push_back(row);
    }
    return rows;
}

/* The queries about single points, edges and triangles. */
static void check_neighbours(job &j, const cgal_delaunay &oracle)
{
    oracle_rows lists = oracle.lists(false);
    for (int i = 0; i < 6 && !lists.empty(); i++) {
        const oracle_row &row = lists[j.below(lists.size())];
        uint32_t a = row[0];
        std::string point = " " + j.set + " " + std::to_string(a);
        oracle_rows around = oracle.around(a), edges;
        for (size_t k = 1; k < row.size(); k++)
            edges.push_back({std::min(a, row[k]), std::max(a, row[k])});
        expect_rows(j, "EDGES" + point, "", edges);
        expect_rows(j, "TRIANGLES" + point, "", around);
        if (row.size() < 2)
            continue;
        uint32_t b = row[1 + j.below(row.size() - 1)];
        expect_rows(j, "TRIANGLES" + point + " " + std::to_string(b), "",
                    left_of(oracle, {{a, b}, {b, a}}));
        if (around.empty())
            continue;
        const oracle_row &t = around[j.below(around.size())];
        expect_rows(j, "TRIANGLES " + j.set + " " + row_text(t), "",
                    left_of(oracle, {{t[1], t[0]}, {t[2], t[1]}, {t[0], t[2]}}));
    }
}

/* LISTS of a few points: the same rows, in the order of the whole table. */
static void check_some_lists(job &j, const cgal_delaunay &oracle, bool cw)
{
    oracle_rows lists = oracle.lists(cw), rows;
    std::string request = "LISTS " + j.set;
    std::vector<bool> chosen(lists.size());
    size_t interior = 0;
    for (size_t i = 0; i < 1 + lists.size() / 10 && i < 50 && !lists.empty(); i++) {
        size_t at = j.below(lists.size());
        chosen[at] = true;
        request += " " + std::to_string(lists[at][0]);
    }
    for (size_t i = 0; i < lists.size(); i++)
        if (chosen[i]) {
            rows.push_back(lists[i]);
            interior += i < oracle.interior();
        }
    if (!rows.empty())
        expect_rows(j, request + (cw ? " CW" : ""),
                    " interior=" + std::to_string(interior) +
                        " boundary=" + std::to_string(rows.size() - interior),
                    rows);
}

static void check_queries(job &j, const cgal_delaunay &oracle)
{
    check_places(j, oracle);
    check_many_places(j, oracle);
    check_ranges(j, oracle);
    check_neighbours(j, oracle);
    check_some_lists(j, oracle, j.seed % 2 == 0);
}

/* ---- loading and editing ---- */

static std::vector<oracle_point> family_of(job &j, size_t n, uint64_t seed)
{
    std::vector<dt_point> p(n + 1);
    std::vector<oracle_point> points;
    family_points(&j.kind, p.data(), n, seed);
    for (size_t i = 0; i < n; i++)
        points.push_back({j.next_id + static_cast<uint32_t>(i), p[i].x, p[i].y});
    return points;
}

static std::string load_text(job &j, const std::vector<oracle_point> &points)
{
    std::string request;
    if (j.seed % 3 == 0) {
        request = "LOADB " + j.set + " " + std::to_string(points.size()) + "\n";
        for (const oracle_point &p : points) {
            double xy[2] = {p.x, p.y};
            request.append(reinterpret_cast<const char *>(xy), sizeof xy);
        }
        return request;
    }
    bool counted = j.seed % 3 == 1;
    request = "LOAD " + j.set + (counted ? " " + std::to_string(points.size()) : "") + "\n";
    for (const oracle_point &p : points)
        request += number_text(p.x) + " " + number_text(p.y) + "\n";
    return request + (counted ? "" : ".\n");
}

static void load(job &j)
{
    std::vector<oracle_point> points = family_of(j, j.n, j.seed);
    for (const oracle_point &p : points)
        j.live[p.id] = p;
    j.next_id += static_cast<uint32_t>(points.size());
    std::string coincident = std::to_string(fresh_oracle(j).coincident().size());
    j.daemon.send(load_text(j, points));
    expect_text("LOAD", j.daemon.receive().status,
                "OK 0 first=0 added=" + std::to_string(points.size()) +
                    " coincident=" + coincident);
}

static uint32_t random_live(job &j)
{
    return std::next(j.live.begin(), static_cast<ptrdiff_t>(j.below(j.live.size())))->first;
}

/* One edit of the model; returns its request and how its reply begins. */
static std::pair<std::string, std::string> random_edit(job &j,
                                                       const std::vector<oracle_point> &fresh)
{
    size_t kind = j.live.size() < 3 ? 0 : j.below(4);
    oracle_point p = fresh[j.below(fresh.size())];
    if (j.below(5) == 0 && !j.live.empty())
        p = j.live.at(random_live(j)); /* lands on another point */
    std::string place = number_text(p.x) + " " + number_text(p.y);
    if (kind < 2) {
        p.id = j.next_id++;
        j.live[p.id] = p;
        return {"ADD " + j.set + " " + place, "OK 0 first=" + std::to_string(p.id) + " added=1 "};
    }
    uint32_t id = random_live(j);
    if (kind == 2) {
        j.live.erase(id);
        return {"DEL " + j.set + " " + std::to_string(id), "OK 0 deleted=1"};
    }
    p.id = id;
    j.live[id] = p;
    return {"MOVE " + j.set + " " + std::to_string(id) + " " + place, "OK 0"};
}

/* A pipelined batch of edits. */
static void edit(job &j, unsigned round)
{
    std::vector<oracle_point> fresh = family_of(j, j.n + 1, j.seed + 1000 * (round + 1));
    std::vector<std::pair<std::string, std::string>> edits;
    std::string request;
    for (size_t i = 0; i < 5 + std::min<size_t>(j.n / 3, 400); i++) {
        edits.push_back(random_edit(j, fresh));
        request += edits.back().first + "\n";
    }
    j.daemon.send(request);
    for (const auto &e : edits) {
        std::string got = j.daemon.receive().status;
        expect(got.compare(0, e.second.size(), e.second) == 0, e.first, got, e.second);
    }
}

/* ---- jobs ---- */

static void triangulate(job &j, const cgal_delaunay &oracle, const char *method)
{
    std::string got = j.daemon.ask("TRIANGULATE " + j.set + " METHOD " + method).status;
    std::string want = "OK 0 " + counts_text(oracle) + " ms=";
    expect(got.compare(0, want.size(), want) == 0, std::string("TRIANGULATE METHOD ") + method, got,
           want);
}

static void run(job &j)
{
    load(j);
    cgal_delaunay oracle = fresh_oracle(j);
    for (const char *method : {"divide", "shelling", "auto"}) {
        triangulate(j, oracle, method);
        check_tables(j, oracle, j.seed % 2 == 1);
    }
    check_queries(j, oracle);
    for (unsigned round = 0; round < 3; round++) {
        edit(j, round);
        cgal_delaunay edited = fresh_oracle(j);
        check_tables(j, edited, round == 1);
        check_queries(j, edited);
    }
    expect_text("DROP", j.daemon.ask("DROP " + j.set).status, "OK 0");
}

/* A set so large that the divide engine sorts it by tiles first: its tables, once. */
static void run_large(job &j)
{
    load(j);
    cgal_delaunay oracle = fresh_oracle(j);
    triangulate(j, oracle, "divide");
    check_tables(j, oracle, false);
    expect_text("DROP", j.daemon.ask("DROP " + j.set).status, "OK 0");
}

/* Returns whether the job passed. */
static bool try_job(int port, const family &kind, size_t n, unsigned seed, void (*run_it)(job &))
{
    std::string name =
        std::string(kind.name) + "." + std::to_string(n) + "." + std::to_string(seed);
    try {
        daemon_link daemon(port);
        job j{daemon, kind, n, seed, name, std::mt19937_64(seed), {}, 0};
        run_it(j);
        return true;
    } catch (const std::exception &e) {
        std::string what = e.what();
        std::printf("FAIL %s: %s\n", name.c_str(), what.substr(0, 2000).c_str());
        return false;
    }
}

int main(int argc, char **argv)
{
    static const struct {
        size_t n;
        unsigned seeds;
    } sizes[] = {{0, 1}, {1, 1},  {2, 2},   {3, 3},    {4, 3},    {5, 3},
                 {8, 3}, {40, 6}, {300, 3}, {2000, 2}, {20000, 1}};
    int port = argc > 1 ? std::atoi(argv[1]) : 0, shard = argc > 3 ? std::atoi(argv[2]) : 0;
    int shards = argc > 3 ? std::atoi(argv[3]) : 1, passed = 0, failed = 0, count = 0;
    for (const auto &size : sizes)
        for (const family *f = families; f->name != NULL; f++)
            for (unsigned seed = 1; seed <= size.seeds; seed++) {
                if (argc > 4 && std::strcmp(argv[4], f->name) != 0)
                    continue;
                if (count++ % shards != shard)
                    continue;
                bool ok = try_job(port, *f, size.n, seed + static_cast<unsigned>(size.n), run);
                passed += ok;
                failed += !ok;
            }
    for (const char *name :
         {"gaussian", "kuzmin"}) { /* most tiles are full, some are nearly empty */
        if ((argc > 4 && std::strcmp(argv[4], name) != 0) || count++ % shards != shard)
            continue;
        bool ok = try_job(port, *family_find(name), 1000000, 2, run_large);
        passed += ok;
        failed += !ok;
    }
    std::printf("%d passed, %d failed\n", passed, failed);
    return failed != 0 || passed == 0;
}
