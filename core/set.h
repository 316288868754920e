/* set.h - what a struct dt consists of; for the files of core/ only. */
#ifndef DT_SET_H
#define DT_SET_H

#include "core/locate.h"
#include "core/mesh.h"
#include "core/points.h"

struct dt {
    struct dt_points points; /* who is where */
    struct dt_mesh mesh;     /* who is joined to whom; its vertex numbers are those of points */
    struct dt_hints hints;   /* the uniform grid: a half edge near every place */
    bool triangulated;       /* dt_triangulate has been called */
    bool current;            /* mesh and hints agree with points */
};

#endif
