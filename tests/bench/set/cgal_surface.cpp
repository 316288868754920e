/* cgal_surface.cpp - values between points with CGAL, at the places of surface.c: linear ones with locate and barycentric
 * coordinates, Sibson's with natural_neighbor_coordinates_2. Cells of a raster are located from the face of the previous
 * one, other places through the hierarchy.
 *
 *     cgal_surface N K      prints ns each, one line for each kind of surface_plan.h, 0 where CGAL has no equivalent */
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_hierarchy_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/natural_neighbor_coordinates_2.h>

#include <stdatomic.h>
extern "C" {
#include "tests/bench/measure.h"
#include "tests/bench/set/live_plan.h"
}
#include "tests/bench/set/surface_plan.h"

#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <utility>
#include <vector>

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using with_value = CGAL::Triangulation_vertex_base_with_info_2<double, kernel>;
using vertex_base = CGAL::Triangulation_hierarchy_vertex_base_2<with_value>;
using delaunay =
    CGAL::Delaunay_triangulation_2<kernel, CGAL::Triangulation_data_structure_2<vertex_base>>;
using triangulation = CGAL::Triangulation_hierarchy_2<delaunay>;
using point = kernel::Point_2;
using face = triangulation::Face_handle;
using vertex = triangulation::Vertex_handle;

static double twice_area(const point &a, const point &b, const point &c)
{
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

static double linear(const triangulation &t, const point &q, face f)
{
    if (t.is_infinite(f))
        return NAN;
    const point &a = f->vertex(0)->point(), &b = f->vertex(1)->point(), &c = f->vertex(2)->point();
    double all = twice_area(a, b, c), u = twice_area(b, c, q) / all, v = twice_area(c, a, q) / all;
    return u * f->vertex(0)->info() + v * f->vertex(1)->info() + (1 - u - v) * f->vertex(2)->info();
}

static double sibson(const triangulation &t, const point &q, face f)
{
    using weight = std::pair<vertex, double>;
    static std::vector<weight> weights;
    weights.clear();
    if (t.is_infinite(f))
        return NAN;
    CGAL::Identity<weight> as_it_is;
    auto sum = CGAL::natural_neighbor_coordinates_2(t, q, std::back_inserter(weights), as_it_is, f);
    double z = 0;
    for (const weight &w : weights)
        z += w.second * w.first->info();
    return z / sum.second;
}

template <class Value, class Place, class Find>
static double measure(const triangulation &t, size_t k, Value value, Place place, Find find)
{
    face f = t.finite_faces_begin();
    double sum = 0, start = measure_cpu();
    for (size_t i = 0; i < k; i++) {
        point q = place(i);
        f = find(q, f);
        double z = value(t, q, f);
        sum += z == z ? z : 1;
    }
    live_keep(static_cast<uint32_t>(std::fabs(sum)));
    return live_ns(start, k);
}

/* Walks along a line and computes its place on each edge that it crosses, in doubles. */
static double profile(const triangulation &t, double begin)
{
    point p(0, begin), q(1, 1 - begin);
    auto walk = t.line_walk(p, q), done = walk;
    double sum = 0;
    if (walk == nullptr)
        return 0;
    do {
        face f = walk;
        for (int i = 0; i < 3 && !t.is_infinite(f); i++) {
            vertex a = f->vertex(t.ccw(i)), b = f->vertex(t.cw(i));
            double right = twice_area(p, q, a->point()), left = twice_area(p, q, b->point());
            if (right >= 0 || left < 0)
                continue;
            double share = right / (right - left);
            double x = a->point().x() + share * (b->point().x() - a->point().x());
            double y = a->point().y() + share * (b->point().y() - a->point().y());
            double z = a->info() + share * (b->info() - a->info());
            sum += z + std::sqrt((x - p.x()) * (x - p.x()) + (y - p.y()) * (y - p.y()));
        }
    } while (++walk != done);
    return sum;
}

static double profiles(const triangulation &t)
{
    double sum = 0, start = measure_cpu();
    for (int i = 0; i < SURFACE_PROFILES; i++)
        sum += profile(t, surface_begin(i));
    live_keep(static_cast<uint32_t>(std::fabs(sum)));
    return live_ns(start, SURFACE_PROFILES);
}

/* The angle at r in degrees, in doubles. */
static double angle(const point &r, const point &p, const point &q)
{
    kernel::Vector_2 u = p - r, v = q - r;
    return std::atan2(u.x() * v.y() - u.y() * v.x(), u * v) * (180 / CGAL_PI);
}

/* Counts triangles by their least angle, and finds the least and the largest of all. */
static double angles(const triangulation &t, size_t n)
{
    size_t count[12] = {};
    double start = measure_cpu(), least = 180, largest = 0;
    for (face f : t.finite_face_handles()) {
        const point &a = f->vertex(0)->point(), &b = f->vertex(1)->point(),
                    &c = f->vertex(2)->point();
        double x = angle(a, b, c), y = angle(b, c, a), z = 180 - x - y;
        double low = std::min(x, std::min(y, z));
        count[static_cast<size_t>(low / 5)]++;
        least = std::min(least, low);
        largest = std::max(largest, std::max(x, std::max(y, z)));
    }
    live_keep(static_cast<uint32_t>(count[3] + static_cast<size_t>(least + largest)));
    return live_ns(start, n);
}

int main(int argc, char **argv)
{
    if (argc != 3)
        return 2;
    live_plan plan =
        live_plan_new(std::strtoul(argv[1], nullptr, 10), std::strtoul(argv[2], nullptr, 10));
    std::vector<point> points;
    for (size_t i = 0; i < plan.n; i++)
        points.emplace_back(plan.start[i].x, plan.start[i].y);
    triangulation t(points.begin(), points.end());
    for (vertex v : t.finite_vertex_handles())
        v->info() = surface_height(v->point().x(), v->point().y());
    size_t side = static_cast<size_t>(std::sqrt(static_cast<double>(plan.k)));
    auto cell = [side](size_t i) {
        double n = 2.0 * static_cast<double>(side);
        return point(static_cast<double>(2 * (i % side) + 1) / n,
                     1 - static_cast<double>(2 * (i / side) + 1) / n);
    };
    auto anywhere = [&plan](size_t i) { return point(plan.query[i].x, plan.query[i].y); };
    auto from_the_last = [&t](const point &q, face f) { return t.delaunay::locate(q, f); };
    auto from_above = [&t](const point &q, face) { return t.locate(q); };
    double ns[SURFACE_KINDS] = {};
    ns[SURFACE_LINEAR] = measure(t, side * side, linear, cell, from_the_last);
    ns[SURFACE_NATURAL] = measure(t, side * side, sibson, cell, from_the_last);
    ns[SURFACE_LINEAR_ANYWHERE] = measure(t, plan.k, linear, anywhere, from_above);
    ns[SURFACE_NATURAL_ANYWHERE] = measure(t, plan.k, sibson, anywhere, from_above);
    ns[SURFACE_ANGLES] = angles(t, plan.n);
    ns[SURFACE_PROFILE] = profiles(t);
    for (double x : ns)
        std::printf("%.1f\n", x);
    live_plan_free(&plan);
}
