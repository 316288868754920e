/* vrt_frame_test.c - GDAL's description of a raster says where its cells lie. */
#include "clients/grids/vrt_frame.h"

#include <string.h>

#include "tests/test.h"

static const char *read_text(const char *text, struct grid_frame *g)
{
    return vrt_read_frame(text, strlen(text), g);
}

#define SIZE "<VRTDataset rasterXSize=\"3\" rasterYSize=\"2\">"
#define PLACE                                                                                      \
    "<GeoTransform>  1.0000000000000001e-01,  2.9999999999999999e-01,  0.5,  1.06e+01, 0.25, "     \
    "-2.9999999999999999e-01</GeoTransform>"
#define BAND                                                                                       \
    "<VRTRasterBand dataType=\"Float64\" band=\"1\"><NoDataValue>1</NoDataValue></VRTRasterBand>"

TEST(a_description_of_a_raster_gives_its_frame_with_all_digits)
{
    struct grid_frame g;
    CHECK(read_text(SIZE "<SRS>PROJCS[\"x\",GEOGCS[\"y\"]]</SRS>" PLACE BAND "</VRTDataset>", &g) ==
          NULL);
    CHECK(g.columns == 3 && g.rows == 2 && !g.geographic);
    CHECK(g.origin[0] == 0.1 && g.origin[1] == 10.6 && g.first[0] == 0.5 && g.first[1] == 0.5);
    CHECK(g.column[0] == 0.3 && g.column[1] == 0.25 && g.row[0] == 0.5 && g.row[1] == -0.3);
    CHECK(read_text(SIZE "<SRS>GEOGCS[\"y\"]</SRS>" PLACE BAND "</VRTDataset>", &g) == NULL &&
          g.geographic && !g.scaled);
    CHECK(read_text(SIZE "<SRS>COMPD_CS[\"x\",GEOGCS[\"y\"],VERT_CS[\"z\"]]</SRS>" PLACE BAND,
                    &g) == NULL &&
          g.geographic);
    CHECK(read_text(SIZE PLACE "<VRTRasterBand><Scale>0.1</Scale></VRTRasterBand>", &g) == NULL &&
          g.scaled);
}

TEST(a_raster_of_several_bands_or_without_a_place_is_refused)
{
    struct grid_frame g;
    CHECK_STR(read_text(SIZE PLACE BAND BAND "</VRTDataset>", &g),
              "the raster has several bands; gdal_translate -b 1 IN OUT chooses one");
    const char *fault = read_text(SIZE BAND "</VRTDataset>", &g);
    CHECK(fault != NULL && strstr(fault, "does not say where it lies") != NULL);
    fault = read_text(SIZE "<GeoTransform>0,1,0,0,0</GeoTransform>" BAND "</VRTDataset>", &g);
    CHECK(fault != NULL && strstr(fault, "does not say where it lies") != NULL);
    fault = read_text(SIZE PLACE BAND "<MaskBand>" BAND "</MaskBand></VRTDataset>", &g);
    CHECK(fault != NULL && strstr(fault, "the raster has a mask; gdalwarp -dstnodata") == fault);
    fault = read_text(SIZE PLACE BAND BAND "<MaskBand>" BAND "</MaskBand></VRTDataset>", &g);
    CHECK(fault != NULL && strstr(fault, "several bands") != NULL);
    CHECK_STR(read_text(SIZE PLACE "<VRTRasterBand dataType=\"CFloat32\"></VRTRasterBand>", &g),
              "the values of the raster are complex numbers");
    CHECK_STR(read_text(SIZE "<GeoTransform>0,1,2,0,2,4</GeoTransform>" BAND "</VRTDataset>", &g),
              "the cells of the raster have no area");
    static const char *const odd[] = {"", "<a>", SIZE PLACE "</VRTDataset>", PLACE BAND,
                                      "<VRTDataset rasterXSize='0' rasterYSize='2'>" PLACE BAND};
    for (size_t i = 0; i < sizeof odd / sizeof odd[0]; i++)
        CHECK_STR(read_text(odd[i], &g), "GDAL's description of the raster is not understood");
}
