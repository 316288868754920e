/* cgal_delaunay.cpp - the answers of CGAL, whose perturbation of ties [Devillers & Teillaud 2003] is the
 * same as ours.
 *
 * CGAL keeps the id of whichever coincident point it inserts last, so coincident points are removed
 * before. */
#include "tests/oracle/cgal_delaunay.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/MP_Float.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

using kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using vertex_base = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, kernel>;
using triangulation =
    CGAL::Delaunay_triangulation_2<kernel, CGAL::Triangulation_data_structure_2<vertex_base>>;
using place = kernel::Point_2;

struct cgal_delaunay::body {
    std::vector<oracle_point> points;
    oracle_rows coincident;
    triangulation t;
    std::unordered_map<uint32_t, triangulation::Vertex_handle> vertex;

    oracle_row hull_counterclockwise() const;
    oracle_row line() const;
    oracle_row ring(uint32_t id, bool *boundary) const;
};

oracle_row from_smallest(oracle_row row)
{
    std::rotate(row.begin(), std::min_element(row.begin(), row.end()), row.end());
    return row;
}

static bool by_place(const oracle_point &a, const oracle_point &b)
{
    return std::make_tuple(a.x, a.y, a.id) < std::make_tuple(b.x, b.y, b.id);
}

static bool by_id(const oracle_point &a, const oracle_point &b)
{
    return a.id < b.id;
}

cgal_delaunay::cgal_delaunay(const std::vector<oracle_point> &live) : b(new body)
{
    std::vector<oracle_point> sorted = live;
    std::sort(sorted.begin(), sorted.end(), by_place);
    for (const oracle_point &p : sorted) {
        if (!b->points.empty() && b->points.back().x == p.x && b->points.back().y == p.y)
            b->coincident.push_back({p.id, b->points.back().id});
        else
            b->points.push_back(p);
    }
    std::sort(b->points.begin(), b->points.end(), by_id);
    std::sort(b->coincident.begin(), b->coincident.end());
    std::vector<std::pair<place, uint32_t>> input;
    for (const oracle_point &p : b->points)
        input.emplace_back(place(p.x, p.y), p.id);
    b->t.insert(input.begin(), input.end());
    for (auto v = b->t.finite_vertices_begin(); v != b->t.finite_vertices_end(); ++v)
        b->vertex[v->info()] = v;
}

cgal_delaunay::~cgal_delaunay() = default;

const std::vector<oracle_point> &cgal_delaunay::points() const
{
    return b->points;
}

const oracle_rows &cgal_delaunay::coincident() const
{
    return b->coincident;
}

/* All points on one line: from the end with the smaller id. */
oracle_row cgal_delaunay::body::line() const
{
    std::vector<oracle_point> sorted = points;
    std::sort(sorted.begin(), sorted.end(), by_place);
    oracle_row row;
    for (const oracle_point &p : sorted)
        row.push_back(p.id);
    if (!row.empty() && row.back() < row.front())
        std::reverse(row.begin(), row.end());
    return row;
}

/* Counterclockwise around the infinite vertex is clockwise along the hull. */
oracle_row cgal_delaunay::body::hull_counterclockwise() const
{
    oracle_row row;
    auto v = t.incident_vertices(t.infinite_vertex()), end = v;
    do
        row.push_back(v->info());
    while (++v != end);
    std::reverse(row.begin(), row.end());
    return from_smallest(row);
}

oracle_row cgal_delaunay::hull(bool cw) const
{
    oracle_row row = b->t.dimension() < 2 ? b->line() : b->hull_counterclockwise();
    if (cw)
        std::reverse(row.begin(), row.end());
    return cw && b->t.dimension() == 2 ? from_smallest(row) : row;
}

/* The neighbours of a point of a two-dimensional triangulation, counterclockwise, in canonical
 * order. Around a point of the hull, the infinite vertex stands between the last neighbour and the
 * first. */
oracle_row cgal_delaunay::body::ring(uint32_t id, bool *boundary) const
{
    auto v = t.incident_vertices(vertex.at(id)), end = v;
    oracle_row row;
    *boundary = false;
    do {
        if (!t.is_infinite(v))
            continue;
        *boundary = true;
        end = v;
        break;
    } while (++v != end);
    do
        if (!t.is_infinite(v))
            row.push_back(v->info());
    while (++v != end);
    return *boundary ? row : from_smallest(row);
}

oracle_rows cgal_delaunay::lists(bool cw) const
{
    oracle_rows rows;
    oracle_row walk = hull(cw);
    for (const oracle_point &p : b->points) {
        bool boundary = true;
        oracle_row row;
        if (b->t.dimension() == 2)
            row = b->ring(p.id, &boundary);
        if (boundary)
            continue;
        if (cw)
            std::reverse(row.begin(), row.end());
        row = from_smallest(row);
        row.insert(row.begin(), p.id);
        rows.push_back(row);
    }
    for (size_t i = 0; i < walk.size(); i++) {
        bool boundary;
        oracle_row row;
        if (b->t.dimension() == 2) {
            row = b->ring(walk[i], &boundary);
            if (cw)
                std::reverse(row.begin(), row.end());
        } else {
            if (i + 1 < walk.size())
                row.push_back(walk[i + 1]);
            if (i > 0)
                row.push_back(walk[i - 1]);
        }
        row.insert(row.begin(), walk[i]);
        rows.push_back(row);
    }
    return rows;
}

size_t cgal_delaunay::interior() const
{
    return b->points.size() - hull(false).size();
}

oracle_rows cgal_delaunay::triangles(bool cw) const
{
    oracle_rows rows;
    if (b->t.dimension() < 2)
        return rows;
    for (auto f = b->t.finite_faces_begin(); f != b->t.finite_faces_end(); ++f) {
        oracle_row row = {f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()};
        if (cw)
            std::swap(row[1], row[2]);
        rows.push_back(from_smallest(row));
    }
    std::sort(rows.begin(), rows.end());
    return rows;
}

oracle_rows cgal_delaunay::edges() const
{
    oracle_rows rows;
    for (auto e = b->t.finite_edges_begin(); e != b->t.finite_edges_end(); ++e) {
        bool plane = b->t.dimension() == 2;
        uint32_t u = e->first->vertex(plane ? b->t.cw(e->second) : 0)->info();
        uint32_t v = e->first->vertex(plane ? b->t.ccw(e->second) : 1)->info();
        rows.push_back({std::min(u, v), std::max(u, v)});
    }
    std::sort(rows.begin(), rows.end());
    return rows;
}

/* In ring order, so that the triangle number i is the one left of the edge to neighbour number i.
 */
oracle_rows cgal_delaunay::around(uint32_t id) const
{
    oracle_rows rows;
    if (b->t.dimension() < 2)
        return rows;
    bool boundary;
    oracle_row ring = b->ring(id, &boundary);
    for (size_t i = 0; i + boundary < ring.size(); i++)
        rows.push_back(from_smallest({id, ring[i], ring[(i + 1) % ring.size()]}));
    return rows;
}

oracle_row cgal_delaunay::left_of(uint32_t a, uint32_t b) const
{
    for (const oracle_row &row : around(a)) {
        size_t at = static_cast<size_t>(std::find(row.begin(), row.end(), a) - row.begin());
        if (row[(at + 1) % 3] == b)
            return row;
    }
    return {};
}

oracle_row cgal_delaunay::locate(double x, double y) const
{
    triangulation::Locate_type type;
    int i;
    auto f = b->t.locate(place(x, y), type, i);
    if (b->t.dimension() < 1) /* no point or one: CGAL gives no face */
        return type == triangulation::VERTEX ? oracle_row{b->points[0].id} : oracle_row{};
    if (type == triangulation::VERTEX)
        return {f->vertex(i)->info()};
    if (type == triangulation::EDGE) {
        bool plane = b->t.dimension() == 2;
        uint32_t u = f->vertex(plane ? b->t.cw(i) : 0)->info();
        uint32_t v = f->vertex(plane ? b->t.ccw(i) : 1)->info();
        return {std::min(u, v), std::max(u, v)};
    }
    if (type == triangulation::FACE)
        return from_smallest({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
    return {};
}

oracle_row cgal_delaunay::nearest(double x, double y, size_t k) const
{
    std::vector<oracle_point> all = b->points;
    place q(x, y);
    auto nearer = [&](const oracle_point &u, const oracle_point &v) {
        CGAL::Comparison_result c =
            CGAL::compare_distance_to_point(q, place(u.x, u.y), place(v.x, v.y));
        return c == CGAL::EQUAL ? u.id < v.id : c == CGAL::SMALLER;
    };
    k = std::min(k, all.size());
    std::partial_sort(all.begin(), all.begin() + static_cast<ptrdiff_t>(k), all.end(), nearer);
    oracle_row row;
    for (size_t i = 0; i < k; i++)
        row.push_back(all[i].id);
    return row;
}

oracle_row cgal_delaunay::within_box(double x0, double y0, double x1, double y1) const
{
    oracle_row row;
    for (const oracle_point &p : b->points)
        if (x0 <= p.x && p.x <= x1 && y0 <= p.y && p.y <= y1)
            row.push_back(p.id);
    return row;
}

/* The sign of |p - q|^2 - r^2, exactly. */
static int compare_radius(const oracle_point &p, double x, double y, double r)
{
    CGAL::MP_Float dx = CGAL::MP_Float(p.x) - x, dy = CGAL::MP_Float(p.y) - y, radius(r);
    return CGAL::sign(dx * dx + dy * dy - radius * radius);
}

oracle_row cgal_delaunay::within_disc(double x, double y, double r) const
{
    oracle_row row;
    for (const oracle_point &p : b->points) {
        double rough = std::hypot(p.x - x, p.y - y);
        if (rough < r * 0.999 || (rough <= r * 1.001 && compare_radius(p, x, y, r) <= 0))
            row.push_back(p.id);
    }
    return row;
}
