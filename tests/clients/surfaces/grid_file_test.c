/* grid_file_test.c - rasters as ASCII grids and raw values. */
#include "clients/surfaces/grid_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/surfaces/raster_fetch.h"
#include "tests/test.h"

static char *written(const struct grid *g, void (*write)(FILE *, const struct grid *), size_t *n)
{
    char *text = NULL;
    FILE *out = open_memstream(&text, n);
    CHECK(out != NULL);
    write(out, g);
    CHECK(fclose(out) == 0);
    return text;
}

TEST(asc_has_every_digit_and_marks_missing_values)
{
    double z[6] = {1, 0.1, (double)NAN, -2.5e-7, 1e300, 3};
    struct grid g = {.x0 = -0.5, .y0 = 10, .cell = 0.25, .columns = 3, .rows = 2, .value = z};
    size_t n;
    char *text = written(&g, grid_write_asc, &n);
    CHECK_STR(text, "ncols 3\nnrows 2\nxllcorner -0.5\nyllcorner 10\ncellsize 0.25\n"
                    "NODATA_value -9999\n1 0.1 -9999\n-2.5e-7 1e+300 3\n");
    free(text);
    z[0] = -9999; /* a value */
    text = written(&g, grid_write_asc, &n);
    CHECK(
        strstr(text, "NODATA_value -3.4028234663852886e+38\n-9999 0.1 -3.4028234663852886e+38\n"));
    free(text);
}

TEST(bil_has_little_endian_floats_and_a_header)
{
    double z[3] = {1, (double)NAN, -0.5};
    struct grid g = {.x0 = 0, .y0 = 10, .cell = 2, .columns = 3, .rows = 1, .value = z};
    size_t n;
    char *text = written(&g, grid_write_bil, &n);
    CHECK(n == 12 && memcmp(text, "\0\0\x80\x3f\0\x3c\x1c\xc6\0\0\0\xbf", 12) == 0);
    free(text);
    text = written(&g, grid_write_hdr, &n);
    CHECK_STR(text, "BYTEORDER I\nLAYOUT BIL\nNROWS 1\nNCOLS 3\nNBANDS 1\nNBITS 32\n"
                    "PIXELTYPE FLOAT\nBANDROWBYTES 12\nTOTALROWBYTES 12\nULXMAP 1\nULYMAP 11\n"
                    "XDIM 2\nYDIM 2\nNODATA -9999\n");
    free(text);
}

TEST(a_value_that_rounds_to_the_number_of_missing_ones_is_not_missing)
{
    double z[2] = {-9998.9999, (double)NAN};
    struct grid g = {.cell = 1, .columns = 2, .rows = 1, .value = z};
    size_t n;
    char *text = written(&g, grid_write_bil, &n);
    CHECK(n == 8 && memcmp(text, text + 4, 4) != 0);
    free(text);
}

TEST(cells_are_square_and_cover_the_box)
{
    static const double box[4] = {-10, 5, 20, 15};
    struct raster_request r = {.columns = 60};
    struct grid g;
    CHECK(raster_plan(&r, box, &g) && g.columns == 60 && g.rows == 20 && g.cell == 0.5);
    CHECK(g.x0 == -10 && g.y0 == 5 && grid_right(&g) == 20 && grid_top(&g) == 15);
    r = (struct raster_request){.cell = 7};
    CHECK(raster_plan(&r, box, &g) && g.columns == 5 && g.rows == 2 && g.cell == 7);
    r = (struct raster_request){.cell = 0};
    CHECK(raster_plan(&r, box, &g) && g.columns == RASTER_USUAL_COLUMNS && g.rows == 334);
    r = (struct raster_request){.columns = 80, .most_rows = 10};
    CHECK(raster_plan(&r, box, &g) && g.rows == 10 && g.columns == 30);
}

TEST(too_many_cells_are_refused)
{
    static const double box[4] = {0, 0, 1e9, 1}, line[4] = {0, 0, 0, 0};
    struct raster_request r = {.cell = 1};
    struct grid g;
    CHECK(!raster_plan(&r, box, &g));
    r.cell = 1e3;
    CHECK(raster_plan(&r, box, &g) && g.columns == 1000000 && g.rows == 1);
    r.cell = 1e-300;
    CHECK(!raster_plan(&r, box, &g));
    r.cell = 0;
    CHECK(!raster_plan(&r, line, &g));
}
