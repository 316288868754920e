/* surfaces.cpp - values, weights and alpha shapes of a running daemon equal CGAL's.
 *
 *     surfaces PORT [again]
 *
 * A job is a family and a size. It loads points with a field, edits both at random, and after each round compares WEIGHTS and
 * INTERPOLATE, METHOD natural, with CGAL's natural neighbour coordinates, and ALPHA with CGAL's regularised alpha shapes. CGAL
 * constructs in exact arithmetic (Epeck), so that only our errors count: their bounds are those of PROTOCOL.md. The sets stay.
 * With `again` nothing is sent that changes them: what the last round left is compared, after a restart of the daemon.
 * The last line counts the jobs. */
#include "tests/interop/daemon.h"

#include <stdatomic.h> /* C++23 has it, but not inside of extern "C" */
extern "C" {
#include "tests/oracle/families.h"
}

#include <CGAL/Alpha_shape_2.h>
#include <CGAL/Alpha_shape_face_base_2.h>
#include <CGAL/Alpha_shape_vertex_base_2.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/natural_neighbor_coordinates_2.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <thread>

using kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using exact = kernel::FT;
using place = kernel::Point_2;
using vertex_base =
    CGAL::Alpha_shape_vertex_base_2<kernel,
                                    CGAL::Triangulation_vertex_base_with_info_2<uint32_t, kernel>>;
using face_base = CGAL::Alpha_shape_face_base_2<kernel>;
using triangulation =
    CGAL::Delaunay_triangulation_2<kernel,
                                   CGAL::Triangulation_data_structure_2<vertex_base, face_base>>;
using shape = CGAL::Alpha_shape_2<triangulation>;

enum { ROUNDS = 3 };

struct site {
    double x, y, z; /* z: nan if missing */
};

struct job {
    daemon_link &daemon;
    const family &kind;
    size_t n;
    bool again;
    std::string set;
    std::mt19937_64 edits, questions;
    std::map<uint32_t, site> live;
    uint32_t next_id;
};

static size_t below(std::mt19937_64 &random, size_t limit)
{
    return random() % limit;
}

static void require(bool ok, const std::string &what, const std::string &got)
{
    if (!ok)
        throw failure(what + "\n  got  " + got);
}

static std::string all_lines(const reply &r)
{
    std::string text = r.status;
    for (const std::string &line : r.lines)
        text += "\n" + line;
    return text;
}

/* ---- what CGAL has ---- */

/* The field's values by representative, and the triangulation of the representatives. */
struct oracle {
    std::map<uint32_t, site> sites;
    shape mesh;
};

static void build(oracle &o, const job &j)
{
    std::map<std::pair<double, double>, uint32_t> first;
    triangulation t;
    for (const auto &[id, s] : j.live)
        if (first.try_emplace({s.x, s.y}, id).second) {
            o.sites[id] = s;
            t.insert(place(s.x, s.y))->info() = id;
        }
    o.mesh.make_alpha_shape(t.points_begin(), t.points_end());
    for (auto v : o.mesh.finite_vertex_handles())
        v->info() = first.at({CGAL::to_double(v->point().x()), CGAL::to_double(v->point().y())});
}

/* ---- weights and values ---- */

static bool in_range(double v)
{
    return v == 0 || (std::fabs(v) >= 0x1p-142 && std::fabs(v) <= 0x1p201);
}

static const site &any_site(job &j, const oracle &o)
{
    return std::next(o.sites.begin(), (ptrdiff_t)below(j.questions, o.sites.size()))->second;
}

/* In a triangle of three points, halfway between two, or at one. */
static bool choose_place(job &j, const oracle &o, double p[2])
{
    const site &a = any_site(j, o), &b = any_site(j, o), &c = any_site(j, o);
    std::uniform_real_distribution<double> unit;
    double s = unit(j.questions), t = unit(j.questions) * (1 - s);
    size_t kind = below(j.questions, 8);
    if (kind == 0)
        s = 1, t = 0;
    else if (kind < 3)
        s = t = 0.5;
    p[0] = s * a.x + t * b.x + (1 - s - t) * c.x;
    p[1] = s * a.y + t * b.y + (1 - s - t) * c.y;
    return in_range(p[0]) && in_range(p[1]);
}

using weights = std::map<uint32_t, exact>;

/* The number of means of three and more values, and of edges of shapes, that have been compared. */
static size_t means, edges;

/* CGAL's coordinates of a place; none outside the hull. */
static weights natural(const oracle &o, const place &q)
{
    std::vector<std::pair<triangulation::Vertex_handle, exact>> found;
    auto result = CGAL::natural_neighbor_coordinates_2(
        o.mesh, q, std::back_inserter(found), CGAL::Identity<decltype(found)::value_type>());
    weights w;
    if (result.third)
        for (const auto &[v, share] : found)
            if (share != 0)
                w[v->info()] = share / result.second;
    return w;
}

/* Returns the sum of the errors of all weights. */
static exact weight_error(const weights &want, const reply &r, const std::string &what)
{
    weights left = want;
    exact error = 0;
    for (const std::string &line : r.lines) {
        unsigned id;
        double share;
        require(std::sscanf(line.c_str(), "%u %lf", &id, &share) == 2 && left.count(id) == 1, what,
                all_lines(r));
        error += CGAL::abs(left[id] - exact(share));
        left.erase(id);
    }
    require(left.empty(), what + ": a neighbour is missing", all_lines(r));
    return error;
}

static void check_value(job &j, const oracle &o, const weights &want, const std::string &where)
{
    exact mean = 0, least, most, size = 0;
    bool missing = want.empty(), first = true;
    for (const auto &[id, share] : want) {
        double z = o.sites.at(id).z;
        missing = missing || std::isnan(z);
        if (missing)
            break;
        mean += share * exact(z);
        least = first ? exact(z) : std::min(least, exact(z));
        most = first ? exact(z) : std::max(most, exact(z));
        size = std::max(size, exact(std::fabs(z)));
        first = false;
    }
    std::string request = "INTERPOLATE " + j.set + " z" + where + " METHOD natural";
    reply r = j.daemon.ask(request);
    require(r.status == "OK 1" && r.lines.size() == 1, request, all_lines(r));
    double got = std::strtod(r.lines[0].c_str(), nullptr);
    require(std::isnan(got) == missing, request, all_lines(r));
    means += want.size() > 2 && !missing;
    if (!missing)
        require(CGAL::abs(exact(got) - mean) <=
                    (most - least) * exact(0x1p-40) + size * exact(0x1p-51),
                request + ": want " + std::to_string(CGAL::to_double(mean)), all_lines(r));
}

static void check_places(job &j, const oracle &o)
{
    double p[2];
    for (int i = 0; i < 12; i++) {
        if (!choose_place(j, o, p))
            continue;
        std::string where = " " + number_text(p[0]) + " " + number_text(p[1]);
        weights want = natural(o, place(p[0], p[1]));
        reply r = j.daemon.ask("WEIGHTS " + j.set + where + " METHOD natural");
        require(weight_error(want, r, "WEIGHTS" + where) <= exact(0x1p-40), "WEIGHTS" + where,
                all_lines(r));
        check_value(j, o, want, where);
    }
}

/* ---- alpha shapes ---- */

using edge_set = std::set<std::pair<uint32_t, uint32_t>>;

/* The boundary of CGAL's shape, directed so that the shape is on the left. */
static edge_set boundary(oracle &o, double radius)
{
    edge_set found;
    o.mesh.set_mode(shape::REGULARIZED);
    o.mesh.set_alpha(exact(radius) * exact(radius));
    for (auto e = o.mesh.alpha_shape_edges_begin(); e != o.mesh.alpha_shape_edges_end(); ++e) {
        auto [f, i] = *e;
        uint32_t a = f->vertex(shape::ccw(i))->info(), b = f->vertex(shape::cw(i))->info();
        if (o.mesh.classify(f) != shape::INTERIOR)
            std::swap(a, b);
        found.insert({a, b});
    }
    return found;
}

static exact twice_area(const oracle &o, const oracle_row &loop)
{
    exact sum = 0;
    for (size_t i = 0; i < loop.size(); i++) {
        const site &a = o.sites.at(loop[i]), &b = o.sites.at(loop[(i + 1) % loop.size()]);
        sum += exact(a.x) * exact(b.y) - exact(a.y) * exact(b.x);
    }
    return sum;
}

/* The edges of the loops, each of which has the form that PROTOCOL.md promises. */
static edge_set edges_of(const oracle &o, const reply &r, const std::string &what)
{
    edge_set found;
    oracle_row before;
    for (const std::string &line : r.lines) {
        std::istringstream words(line);
        std::string kind;
        size_t k = 0;
        words >> kind >> k;
        oracle_row loop(k);
        for (uint32_t &id : loop)
            words >> id;
        require(words && k > 2 && (kind == "outer" || kind == "hole"), what, line);
        require(loop == from_smallest(loop) && before < loop, what + ": order", line);
        require(std::set<uint32_t>(loop.begin(), loop.end()).size() == k, what + ": twice", line);
        require(twice_area(o, loop) * (kind == "outer" ? 1 : -1) > 0, what + ": turn", line);
        for (size_t i = 0; i < k; i++)
            require(found.insert({loop[i], loop[(i + 1) % k]}).second, what + ": twice", line);
        before = loop;
    }
    edges += found.size();
    return found;
}

/* Some of the circumradii, rounded; so that triangles in and out are near, and on lattices many at the limit. */
static std::vector<double> radii_of(const oracle &o)
{
    std::vector<double> all;
    for (auto f : o.mesh.finite_face_handles()) {
        place c = o.mesh.circumcenter(f);
        all.push_back(
            std::sqrt(CGAL::to_double(CGAL::squared_distance(c, f->vertex(0)->point()).exact())));
    }
    std::sort(all.begin(), all.end());
    std::vector<double> some = {0, 5, 0x1p200};
    for (double part : {0.1, 0.5, 0.8, 0.95})
        if (!all.empty()) {
            double r = all[(size_t)(part * (double)all.size())];
            some.insert(some.end(), {r, std::nextafter(r, 0)});
        }
    return some;
}

static void check_shapes(job &j, oracle &o)
{
    for (double radius : radii_of(o)) {
        if (!in_range(radius))
            continue;
        std::string request = "ALPHA " + j.set + " " + number_text(radius);
        reply r = j.daemon.ask(request);
        require(r.status == "OK " + std::to_string(r.lines.size()), request, r.status);
        edge_set got = edges_of(o, r, request), want = boundary(o, radius);
        require(got == want, request + ": " + std::to_string(want.size()) + " edges", all_lines(r));
    }
}

/* ---- jobs ---- */

static site new_site(job &j, const dt_point &p)
{
    std::uniform_real_distribution<double> height(-1000, 1000);
    return {p.x, p.y, below(j.edits, 20) == 0 ? NAN : height(j.edits)};
}

static void change(job &j, const std::string &request)
{
    if (j.again)
        return;
    reply r = j.daemon.ask(request);
    require(r.status.compare(0, 4, "OK 0") == 0, request, r.status);
}

static void add(job &j, const dt_point &p)
{
    site s = new_site(j, p);
    std::string xy = number_text(s.x) + " " + number_text(s.y);
    if (std::isnan(s.z))
        change(j, "ADD " + j.set + " " + xy);
    else
        change(j, "ADD " + j.set + " FIELDS z " + xy + " " + number_text(s.z));
    j.live[j.next_id++] = s;
}

static void edit(job &j, const dt_point &p)
{
    size_t kind = below(j.edits, 4);
    if (kind == 0 || j.live.size() < 4) {
        add(j, p);
        return;
    }
    auto at = std::next(j.live.begin(), (ptrdiff_t)below(j.edits, j.live.size()));
    std::string id = " " + std::to_string(at->first);
    if (kind == 1) {
        change(j, "DEL " + j.set + id);
        j.live.erase(at);
    } else if (kind == 2) {
        change(j, "MOVE " + j.set + id + " " + number_text(p.x) + " " + number_text(p.y));
        at->second.x = p.x;
        at->second.y = p.y;
    } else {
        at->second.z = new_site(j, p).z;
        change(j, "FSET " + j.set + " z" + id + " " +
                      (std::isnan(at->second.z) ? "nan" : number_text(at->second.z)));
    }
}

static void compare(job &j)
{
    oracle o;
    build(o, j);
    if (o.mesh.dimension() < 2) {
        reply r = j.daemon.ask("ALPHA " + j.set + " 1e30");
        require(r.status == "OK 0", "ALPHA of a line", r.status);
        return;
    }
    check_places(j, o);
    check_shapes(j, o);
}

/* A daemon that has just started builds its triangulations again. */
static void await_triangulation(job &j)
{
    for (int i = 0; i < 6000; i++) {
        if (j.daemon.ask("HULL " + j.set).status.compare(0, 11, "ERR LOADING") != 0)
            return;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    throw failure("still loading after a minute");
}

static void run(job &j)
{
    await_triangulation(j);
    change(j, "CREATE " + j.set);
    for (unsigned round = 0; round < ROUNDS; round++) {
        std::vector<dt_point> p(j.n + 1);
        family_points(&j.kind, p.data(), j.n, round + 1);
        for (size_t i = 0; i < (round == 0 ? j.n : 8 + j.n / 8); i++)
            round == 0 ? add(j, p[i]) : edit(j, p[below(j.edits, j.n)]);
        if (round == 0)
            change(j, "TRIANGULATE " + j.set);
        if (!j.again || round == ROUNDS - 1)
            compare(j);
    }
}

int main(int argc, char **argv)
{
    int port = argc > 1 ? std::atoi(argv[1]) : 0, passed = 0, failed = 0;
    bool again = argc > 2 && std::strcmp(argv[2], "again") == 0;
    for (size_t n : {10, 150})
        for (const family *f = families; f->name != NULL; f++) {
            std::string name = std::string(f->name) + "." + std::to_string(n);
            try {
                daemon_link daemon(port);
                job j{daemon,
                      *f,
                      n,
                      again,
                      "s." + name,
                      std::mt19937_64(n),
                      std::mt19937_64(n + again),
                      {},
                      0};
                run(j);
                passed++;
            } catch (const std::exception &e) {
                std::printf("FAIL surfaces of %s%s: %.2000s\n", name.c_str(),
                            again ? ", after a restart" : "", e.what());
                failed++;
            }
        }
    size_t rounds = again ? 1 : ROUNDS;
    std::printf("%zu means, %zu edges compared\n", means, edges);
    if (means < 200 * rounds || edges < 2000 * rounds) {
        std::printf("FAIL surfaces: that is too little\n");
        failed++;
    }
    std::printf("%d passed, %d failed\n", passed, failed);
    return failed != 0 || passed == 0;
}
