/* refine.cpp - refinement beside CGAL's Delaunay_mesher_2, in processor time of one thread.
 *
 *     refine ANGLE POINTS [FILE]
 *
 * Both programs make a triangulation and refine it, with the same limits. The first two inputs are POINTS random points in a
 * square, and points in a star with a tenth of their number of corners. The next two are an outline of many corners, without and with a
 * limit of lengths. The last input is the rings in FILE, whose lines are `x y`, and `>` before each ring; sides that cross are split
 * first. Best of three runs that alternate. The core's time includes the time of the plan and of carrying it out.
 *
 * On many coasts the peer ends with a segmentation fault, because triangles become flat beside sharp corners. ALONE=1 leaves it out. */
#include <atomic>
extern "C" {
#include "core/delaunay_constraints.h"
}

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <string>
#include <vector>

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using data = CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_2<kernel>,
                                                  CGAL::Delaunay_mesh_face_base_2<kernel>>;
using cdt = CGAL::Constrained_Delaunay_triangulation_2<kernel, data>;
using criteria = CGAL::Delaunay_mesh_size_criteria_2<cdt>;

static dt_pages *pages;

struct job {
    std::string name;
    std::vector<dt_point> points;
    std::vector<dt_constraint> sides;
    double length; /* of edges; 0: any */
};

struct result {
    double seconds = HUGE_VAL;
    size_t points = 0, unrefined = 0;
    double angle = 0;
};

static double seconds()
{
    timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

static void must(dt_status status)
{
    if (status != DT_OK) {
        fprintf(stderr, "refine: %s\n", dt_status_text(status));
        exit(1);
    }
}

static void run_core(const job &j, double angle, result &r)
{
    dt_added added;
    dt_refined plan;
    dt_quality q{};
    struct dt_summary sum;
    size_t n, at;
    uint32_t missing;
    q.angle = angle;
    q.length = j.length;
    q.number = DT_NONE;
    q.most = SIZE_MAX;
    dt *t = dt_new_in(0, pages);
    double start = seconds();
    must(dt_add(t, j.points.data(), j.points.size(), &added));
    must(dt_constrain(t, j.sides.data(), j.sides.size(), nullptr, &n, &missing));
    must(dt_triangulate(t, nullptr));
    must(dt_plan_refine(t, &q, nullptr, &plan));
    double planned = seconds();
    must(dt_add_many(t, plan.change.point, plan.change.n_points, nullptr, &added));
    must(dt_release(t, plan.change.released, plan.change.n_released, nullptr, &n, &at));
    must(dt_constrain(t, plan.change.added, plan.change.n_added, nullptr, &n, &missing));
    must(dt_refresh(t, nullptr));
    double end = seconds();
    if (getenv("PARTS") != nullptr)
        fprintf(stderr, "plan %.3f rest %.3f\n", planned - start, end - planned);
    dt_summary(t, &sum);
    r.seconds = std::min(r.seconds, end - start);
    r.points = sum.points;
    r.unrefined = plan.unrefined;
    r.angle = plan.angle;
    dt_split_clear(&plan.change);
    dt_free(t);
}

static void run_cgal(const job &j, double angle, result &r)
{
    double start = seconds(), sine = std::sin(angle * std::acos(-1) / 180);
    cdt d;
    std::vector<kernel::Point_2> points;
    std::vector<std::pair<size_t, size_t>> sides;
    for (const dt_point &p : j.points)
        points.emplace_back(p.x, p.y);
    for (const dt_constraint &c : j.sides)
        sides.emplace_back(c.a, c.b);
    d.insert_constraints(points.begin(), points.end(), sides.begin(), sides.end());
    d.insert(points.begin(), points.end());
    CGAL::Delaunay_mesher_2<cdt, criteria> mesher(d, criteria(sine * sine, j.length));
    mesher.refine_mesh();
    double end = seconds();
    r.seconds = std::min(r.seconds, end - start);
    r.points = d.number_of_vertices();
}

static void ring(job &j, size_t from)
{
    size_t n = j.points.size() - from;
    for (size_t i = 0; i < n; i++) {
        auto a = static_cast<uint32_t>(from + i), b = static_cast<uint32_t>(from + (i + 1) % n);
        j.sides.push_back({a, b, true, 0});
    }
}

static job square(size_t n)
{
    job j{"random points in a square", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {}, 0};
    std::mt19937_64 bits(1);
    std::uniform_real_distribution<double> unit(0.001, 0.999);
    ring(j, 0);
    while (j.points.size() < n)
        j.points.push_back({unit(bits), unit(bits)});
    return j;
}

/* Corners of a star whose radius is a random walk, and points in the middle. */
static job star(size_t corners, size_t n, double length, const char *name)
{
    job j{name, {}, {}, length};
    std::mt19937_64 bits(2);
    std::normal_distribution<double> step(0, 1);
    std::uniform_real_distribution<double> unit(-0.5, 0.5);
    double radius = 0, pull = 1 - 40.0 / static_cast<double>(corners);
    for (size_t i = 0; i < corners; i++) {
        double a = 2 * std::acos(-1) * static_cast<double>(i) / static_cast<double>(corners);
        radius = pull * radius + 4 * step(bits) / static_cast<double>(corners);
        double r = 1 + radius;
        j.points.push_back({r * std::cos(a), r * std::sin(a)});
    }
    ring(j, 0);
    while (j.points.size() < n)
        j.points.push_back({unit(bits), unit(bits)});
    return j;
}

/* Sides that cross share points there afterwards. */
static void split(job &j)
{
    dt_added added;
    dt_split plan;
    uint32_t missing;
    dt *t = dt_new_in(0, pages);
    must(dt_add(t, j.points.data(), j.points.size(), &added));
    must(dt_plan_split(t, j.sides.data(), j.sides.size(), UINT32_MAX, nullptr, &plan, &missing));
    j.points.insert(j.points.end(), plan.point, plan.point + plan.n_points);
    j.sides.assign(plan.added, plan.added + plan.n_added);
    dt_split_clear(&plan);
    dt_free(t);
}

static job read_rings(const char *path)
{
    job j{path, {}, {}, 0};
    FILE *f = fopen(path, "r");
    char line[256];
    size_t from = 0;
    if (f == nullptr) {
        perror(path);
        exit(1);
    }
    while (fgets(line, sizeof line, f) != nullptr) {
        dt_point p;
        if (line[0] == '>') {
            if (j.points.size() > from)
                ring(j, from);
            from = j.points.size();
        } else if (sscanf(line, "%lf %lf", &p.x, &p.y) == 2) {
            j.points.push_back(p);
        }
    }
    fclose(f);
    ring(j, from);
    split(j);
    return j;
}

static void compare(const job &j, double angle)
{
    result core, cgal;
    for (int i = 0; i < 3; i++) {
        run_core(j, angle, core);
        if (getenv("ALONE") == nullptr)
            run_cgal(j, angle, cgal);
    }
    printf("| %s | %zu | %zu | %zu | %.2f | %.4f | %.4f | %.3f | %.2f | %zu |\n", j.name.c_str(),
           j.points.size(), core.points, cgal.points,
           static_cast<double>(core.points) / static_cast<double>(cgal.points), core.seconds,
           cgal.seconds, core.seconds / cgal.seconds, core.angle, core.unrefined);
    fflush(stdout);
}

int main(int argc, char **argv)
{
    if (argc < 3) {
        fputs("usage: refine ANGLE POINTS [FILE]\n", stderr);
        return 2;
    }
    double angle = atof(argv[1]);
    auto n = static_cast<size_t>(atof(argv[2]));
    pages = dt_pages_new(SIZE_MAX);
    printf("| refined to %g degrees | points | then | CGAL's | ratio | s | CGAL s | ratio | least "
           "angle | not refined |\n"
           "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
           angle);
    compare(square(n), angle);
    compare(star(n / 10 + 3, n, 0, "points in a star"), angle);
    compare(star(n / 20 + 3, 0, 0, "an outline"), angle);
    compare(star(n / 20 + 3, 0, 2.2 / std::sqrt(static_cast<double>(n) + 1),
                 "an outline with short edges"),
            angle);
    if (argc > 3)
        compare(read_rings(argv[3]), angle);
}
