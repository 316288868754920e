/* cgal_live.cpp - the operations of live.c with CGAL's Triangulation_hierarchy_2, with an id at every
 * vertex.
 *
 *     cgal_live N K         prints ns per operation, one line for each kind of live_plan.h */
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_hierarchy_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <stdatomic.h>
extern "C" {
#include "tests/bench/measure.h"
#include "tests/bench/set/live_plan.h"
}

#include <cstdio>
#include <cstdlib>
#include <vector>

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using with_id = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, kernel>;
using vertex_base = CGAL::Triangulation_hierarchy_vertex_base_2<with_id>;
using hierarchy = CGAL::Triangulation_hierarchy_2<
    CGAL::Delaunay_triangulation_2<kernel, CGAL::Triangulation_data_structure_2<vertex_base>>>;

static kernel::Point_2 place(struct dt_point p)
{
    return {p.x, p.y};
}

int main(int argc, char **argv)
{
    if (argc != 3)
        return 2;
    live_plan plan =
        live_plan_new(std::strtoul(argv[1], nullptr, 10), std::strtoul(argv[2], nullptr, 10));
    double ns[LIVE_KINDS];
    std::vector<kernel::Point_2> points;
    for (size_t i = 0; i < plan.n; i++)
        points.push_back(place(plan.start[i]));
    hierarchy t(points.begin(), points.end());
    std::vector<hierarchy::Vertex_handle> vertex(plan.n);
    for (size_t i = 0; i < plan.n; i++)
        vertex[i] = t.nearest_vertex(points[i]);

    uint32_t sum = 0;
    double start = measure_cpu();
    for (size_t i = 0; i < plan.k; i++)
        sum += t.is_infinite(t.locate(place(plan.query[i])));
    ns[LIVE_LOCATE] = live_ns(start, plan.k);
    start = measure_cpu();
    for (size_t i = 0; i < plan.k; i++)
        sum += t.nearest_vertex(place(plan.query[i])) == vertex[0];
    ns[LIVE_NEAREST] = live_ns(start, plan.k);
    live_keep(sum);

    start = measure_cpu();
    for (size_t i = 0; i < plan.k; i++) {
        t.remove(vertex[plan.mover[i]]);
        vertex[plan.mover[i]] = t.insert(place(plan.moved[i]));
    }
    ns[LIVE_MOVE] = live_ns(start, plan.k);
    start = measure_cpu();
    for (size_t i = 0; i < plan.k; i++)
        t.insert(place(plan.query[i]));
    ns[LIVE_INSERT] = live_ns(start, plan.k);
    ns[LIVE_BATCH] = ns[LIVE_INSERT];
    start = measure_cpu();
    for (size_t i = 0; i < plan.k; i++)
        t.remove(vertex[plan.victim[i]]);
    ns[LIVE_DELETE] = live_ns(start, plan.k);
    for (double x : ns)
        std::printf("%.1f\n", x);
    live_plan_free(&plan);
}
