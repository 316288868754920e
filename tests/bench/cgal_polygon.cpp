/* cgal_polygon.cpp - the triangles inside a polygon by CGAL: constrained Delaunay, then domains marked from the outside.
 *
 *     cgal_polygon RUNS <corners
 *
 * corners: doubles x, y of one ring that does not cross itself. Prints the least processor time in seconds of the runs, and the number of
 * triangles inside. Domains are marked as CGAL's manual does (2D Triangulations, "Triangulating a polygonal domain"). */
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <deque>
#include <vector>

struct nesting {
    int level = -1;
};

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using vertex_base = CGAL::Triangulation_vertex_base_with_info_2<unsigned, kernel>;
using info_base = CGAL::Triangulation_face_base_with_info_2<nesting, kernel>;
using face_base = CGAL::Constrained_triangulation_face_base_2<kernel, info_base>;
using cdt = CGAL::Constrained_Delaunay_triangulation_2<
    kernel, CGAL::Triangulation_data_structure_2<vertex_base, face_base>>;

/* Gives the faces around `start` that no constraint separates from it a level; appends the constraints met. */
static void flood(const cdt &t, cdt::Face_handle start, int level, std::deque<cdt::Edge> &border)
{
    std::vector<cdt::Face_handle> stack{start};
    while (!stack.empty()) {
        cdt::Face_handle f = stack.back();
        stack.pop_back();
        if (f->info().level != -1)
            continue;
        f->info().level = level;
        for (int i = 0; i < 3; i++) {
            cdt::Face_handle g = f->neighbor(i);
            if (g->info().level != -1)
                continue;
            if (t.is_constrained({f, i}))
                border.push_back({f, i});
            else
                stack.push_back(g);
        }
    }
}

static size_t mark_domains(cdt &t)
{
    std::deque<cdt::Edge> border;
    flood(t, t.infinite_face(), 0, border);
    while (!border.empty()) {
        cdt::Edge e = border.front();
        border.pop_front();
        cdt::Face_handle g = e.first->neighbor(e.second);
        if (g->info().level == -1)
            flood(t, g, e.first->info().level + 1, border);
    }
    size_t inside = 0;
    for (auto f : t.finite_face_handles())
        inside += f->info().level % 2 == 1;
    return inside;
}

static size_t triangulate(const std::vector<kernel::Point_2> &ring)
{
    std::vector<std::pair<kernel::Point_2, unsigned>> points;
    std::vector<cdt::Vertex_handle> handle(ring.size());
    cdt t;
    for (unsigned i = 0; i < ring.size(); i++)
        points.emplace_back(ring[i], i);
    t.insert(points.begin(), points.end());
    for (auto v : t.finite_vertex_handles())
        handle[v->info()] = v;
    for (size_t i = 0; i < ring.size(); i++)
        t.insert_constraint(handle[i], handle[(i + 1) % ring.size()]);
    return mark_domains(t);
}

int main(int argc, char **argv)
{
    std::vector<kernel::Point_2> ring;
    double xy[2], least = 1e9;
    size_t inside = 0;
    while (fread(xy, sizeof xy, 1, stdin) == 1)
        ring.emplace_back(xy[0], xy[1]);
    for (int i = 0; i < (argc > 1 ? atoi(argv[1]) : 3); i++) {
        clock_t start = clock();
        inside = triangulate(ring);
        least = std::min(least, static_cast<double>(clock() - start) / CLOCKS_PER_SEC);
    }
    printf("%.6f %zu\n", least, inside);
    return 0;
}
