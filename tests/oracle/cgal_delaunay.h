/* cgal_delaunay.h - the answers of PROTOCOL.md from an independent source: CGAL or brute force.
 *
 * Rows are words in our canonical order: what a whole-set table of the protocol must contain. Needs
 * libcgal-dev; the CGAL headers, slow to compile, stay in cgal_delaunay.cpp. */
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

struct oracle_point {
    uint32_t id;
    double x, y;
};

using oracle_row = std::vector<uint32_t>;
using oracle_rows = std::vector<oracle_row>;

/* The triangulation of the live points of a set with TOL 0, given by ascending id. Points of equal
 * coordinates are represented by the lowest id among them. */
class cgal_delaunay
{
  public:
    explicit cgal_delaunay(const std::vector<oracle_point> &live);
    ~cgal_delaunay();

    /* The representatives by id, and pairs (alias, representative) by alias. */
    const std::vector<oracle_point> &points() const;
    const oracle_rows &coincident() const;

    oracle_rows triangles(bool cw) const; /* a b c, from the smallest, sorted */
    oracle_rows edges() const;            /* a < b, sorted */
    oracle_row hull(bool cw) const;       /* from the smallest id; a line from its smaller end */
    oracle_rows
    lists(bool cw) const;    /* id, ring: interior points by id, boundary points along the hull */
    size_t interior() const; /* how many rows of lists are interior points */
    oracle_rows around(
        uint32_t id) const; /* the triangles at a point, in ring order, each from its smallest id */
    oracle_row left_of(uint32_t a,
                       uint32_t b) const; /* the triangle left of the edge a->b; empty if none */

    /* inside: a b c; edge: a < b; vertex: a; outside: nothing. */
    oracle_row locate(double x, double y) const;

    /* The k nearest, nearest first, ties by id. */
    oracle_row nearest(double x, double y, size_t k) const;

    /* By brute force, by id. */
    oracle_row within_box(double x0, double y0, double x1, double y1) const;
    oracle_row within_disc(double x, double y, double r) const;

  private:
    struct body;
    std::unique_ptr<body> b;
};

/* The row rotated so that its smallest word comes first. */
oracle_row from_smallest(oracle_row row);
