/* cgal_speed.cpp - time and memory of CGAL for a family of point sets.
 *
 *     cgal_speed FAMILY N SETS fresh|warm
 *
 * Prints three figures per input point. First the ns of a bare Delaunay_triangulation_2 from a vector of points, which
 * CGAL sorts spatially. Then the ns with an id at every vertex and the list of triangles in ids. Then the
 * peak memory of the latter, in bytes. */
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <stdatomic.h>
extern "C" {
#include "tests/oracle/families.h"
}

#include <climits>
#include <cstdio>
#include <cstring>
#include <malloc.h>
#include <sys/resource.h>
#include <time.h>
#include <vector>

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using bare_triangulation = CGAL::Delaunay_triangulation_2<kernel>;
using vertex_base = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, kernel>;
using id_triangulation =
    CGAL::Delaunay_triangulation_2<kernel, CGAL::Triangulation_data_structure_2<vertex_base>>;
using place = kernel::Point_2;

static double now()
{
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

static double peak()
{
    rusage u;
    getrusage(RUSAGE_SELF, &u);
    return static_cast<double>(u.ru_maxrss) * 1024;
}

static double build_bare(const std::vector<place> &points)
{
    double start = now();
    bare_triangulation t(points.begin(), points.end());
    return now() - start;
}

static double build_with_list(const std::vector<place> &points)
{
    double start = now();
    std::vector<std::pair<place, uint32_t>> input;
    input.reserve(points.size());
    for (size_t i = 0; i < points.size(); i++)
        input.emplace_back(points[i], static_cast<uint32_t>(i));
    id_triangulation t(input.begin(), input.end());
    std::vector<uint32_t> list;
    list.reserve(3 * t.number_of_faces());
    for (auto f = t.finite_faces_begin(); f != t.finite_faces_end(); ++f)
        for (int k = 0; k < 3; k++)
            list.push_back(f->vertex(k)->info());
    double end = now();
    return list.size() == 1 ? 0
                            : end - start; /* using the list keeps the compiler from removing it */
}

static std::vector<place> points_of(const family *f, size_t n, size_t seed)
{
    std::vector<dt_point> p(n);
    std::vector<place> points;
    family_points(f, p.data(), n, seed);
    points.reserve(n);
    for (const dt_point &q : p)
        points.emplace_back(q.x, q.y);
    return points;
}

int main(int argc, char **argv)
{
    const family *f = argc == 6 ? family_find(argv[1]) : nullptr;
    if (f == nullptr)
        return 2;
    size_t n = std::strtoul(argv[2], nullptr, 10), sets = std::strtoul(argv[3], nullptr, 10);
    auto build = std::strcmp(argv[5], "list") == 0 ? build_with_list : build_bare;
    if (std::strcmp(argv[4], "warm") == 0) {
        mallopt(M_MMAP_MAX, 0);
        mallopt(M_TRIM_THRESHOLD, INT_MAX);
        build(points_of(f, n, 1));
    }
    std::vector<place> points = points_of(f, n, 2);
    double seconds = 0, before = peak();
    for (size_t i = 0; i < sets; i++) {
        points = points_of(f, n, 2 + i);
        seconds += build(points);
    }
    std::printf("%.2f %.1f\n", 1e9 * seconds / static_cast<double>(n * sets),
                (peak() - before) / static_cast<double>(n));
}
