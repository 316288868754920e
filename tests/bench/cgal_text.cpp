/* cgal_text.cpp - the local program that the daemon is compared with. It reads lines `x y` from standard input
 * and writes triangles as lines `a b c` of line numbers to standard output, with CGAL. */
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using vertex_base = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, kernel>;
using triangulation =
    CGAL::Delaunay_triangulation_2<kernel, CGAL::Triangulation_data_structure_2<vertex_base>>;

int main()
{
    std::vector<std::pair<kernel::Point_2, uint32_t>> input;
    char line[512], *end;
    while (std::fgets(line, sizeof line, stdin)) {
        double x = std::strtod(line, &end), y = std::strtod(end, nullptr);
        input.emplace_back(kernel::Point_2(x, y), static_cast<uint32_t>(input.size()));
    }
    triangulation t(input.begin(), input.end());
    for (auto f = t.finite_faces_begin(); f != t.finite_faces_end(); ++f)
        std::printf("%u %u %u\n", f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info());
}
