/* grid_file.c - see grid_file.h. Both formats mark what is missing by a number, which must not be a value. */
#include "clients/surfaces/grid_file.h"

#include "clients/meshes/formats.h"

#include <float.h>
#include <math.h>
#include <string.h>

double grid_right(const struct grid *g)
{
    return g->x0 + g->columns * g->cell;
}

double grid_top(const struct grid *g)
{
    return g->y0 + g->rows * g->cell;
}

static size_t cells(const struct grid *g)
{
    return (size_t)g->columns * g->rows;
}

bool grid_range(const struct grid *g, double *least, double *most)
{
    *least = HUGE_VAL;
    *most = -HUGE_VAL;
    for (size_t i = 0; i < cells(g); i++) {
        *least = fmin(*least, g->value[i]); /* the other one where one is nan */
        *most = fmax(*most, g->value[i]);
    }
    return *least <= *most;
}

/* -9999 is what readers know; where values are that low, rounded to a float, the lowest float. */
static double no_data(const struct grid *g)
{
    double least, most;
    return grid_range(g, &least, &most) && (float)least <= -9999 ? -(double)FLT_MAX : -9999;
}

static void put_key(FILE *out, const char *key, double v)
{
    fputs(key, out);
    formats_put_number(out, v);
    putc('\n', out);
}

void grid_write_asc(FILE *out, const struct grid *g)
{
    double missing = no_data(g);
    fprintf(out, "ncols %u\nnrows %u\n", g->columns, g->rows);
    put_key(out, "xllcorner ", g->x0);
    put_key(out, "yllcorner ", g->y0);
    put_key(out, "cellsize ", g->cell);
    put_key(out, "NODATA_value ", missing);
    for (size_t i = 0; i < cells(g); i++) {
        formats_put_number(out, isnan(g->value[i]) ? missing : g->value[i]);
        putc((i + 1) % g->columns == 0 ? '\n' : ' ', out);
    }
}

void grid_write_bil(FILE *out, const struct grid *g)
{
    float missing = (float)no_data(g);
    for (size_t i = 0; i < cells(g); i++) {
        float v = isnan(g->value[i]) ? missing : (float)g->value[i];
        uint32_t bits;
        memcpy(&bits, &v, sizeof bits);
        for (int k = 0; k < 4; k++)
            putc((int)(bits >> (8 * k) & 255), out);
    }
}

void grid_write_hdr(FILE *out, const struct grid *g)
{
    fprintf(out,
            "BYTEORDER I\nLAYOUT BIL\nNROWS %u\nNCOLS %u\nNBANDS 1\nNBITS 32\nPIXELTYPE FLOAT\n"
            "BANDROWBYTES %ju\nTOTALROWBYTES %ju\n",
            g->rows, g->columns, (uintmax_t)4 * g->columns, (uintmax_t)4 * g->columns);
    put_key(out, "ULXMAP ", g->x0 + g->cell / 2);
    put_key(out, "ULYMAP ", grid_top(g) - g->cell / 2);
    put_key(out, "XDIM ", g->cell);
    put_key(out, "YDIM ", g->cell);
    put_key(out, "NODATA ", no_data(g));
}

void world_write(FILE *out, double wide, double high, double x, double y)
{
    const double line[] = {wide,         0,           0, -high,
                           x + wide / 2, y - high / 2}; /* of the first pixel's centre */
    for (size_t i = 0; i < sizeof line / sizeof line[0]; i++)
        put_key(out, "", line[i]);
}
