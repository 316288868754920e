/* headings_test.c - which headings of a table name coordinates. */
#include "clients/reading/headings.h"

#include <string.h>

#include "tests/test.h"

/* The columns that a header of names separated by commas chooses: "1,2", "1,2!" if they are obvious, "?" if
 * it chooses none. */
static const char *choose(const char *header)
{
    static char text[40];
    struct heading_search s = {0};
    size_t columns = 0;
    size_t column[2];
    bool obvious;
    for (const char *p = header;; p++) {
        size_t len = strcspn(p, ",");
        heading_search_add(&s, columns++, p, len);
        p += len;
        if (*p == '\0')
            break;
    }
    if (!heading_search_end(&s, column, &obvious))
        return "?";
    snprintf(text, sizeof text, "%zu,%zu%s", column[0] + 1, column[1] + 1, obvious ? "!" : "");
    return text;
}

TEST(usual_headings_of_coordinates_are_recognised)
{
    static const char *const headers[][2] = {
        {"x,y", "1,2!"},
        {"Y,X", "2,1!"},
        {"id,POINT_X,POINT_Y,z", "2,3"},
        {"E,N", "1,2!"},
        {"name,X_COORD,Y_COORD", "2,3"},
        {"long,lat", "1,2!"},
        {"x[m],y[m]", "1,2"},
        {"east,north", "1,2!"},
        {"Latitude (deg),Longitude (deg)", "2,1"},
        {"utm_x,utm_y", "1,2"},
        {"Hochwert,Rechtswert", "2,1!"},
        {"coordX,coordY", "1,2"},
        {"xcoord,ycoord", "1,2"},
        {"id,X (EPSG:2056),Y (EPSG:2056),Z", "2,3"},
        {"X_4326,Y_4326", "1,2"},
        {"Easting_m,Northing_m", "1,2"},
        {"x-coordinate,y-coordinate", "1,2"},
        {"geo_lat,geo_lon", "2,1"},
        {"lat_wgs84,lng_wgs84", "2,1"},
        {"L\xC3\xA4ngengrad,Breitengrad", "1,2!"},
        {"GPS Position X,GPS Position Y", "1,2"},
        {"PointX,PointY", "1,2"},
        {"Este,Norte", "1,2!"},
    };
    for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++)
        CHECK_MSG(strcmp(choose(headers[i][0]), headers[i][1]) == 0, "%s: %s", headers[i][0],
                  choose(headers[i][0]));
}

TEST(headings_of_other_things_choose_no_columns)
{
    static const char *const headers[] = {"a,b",
                                          "id,name",
                                          "x,lat",
                                          "x,z",
                                          "lon,name",
                                          "x_error,y_error",
                                          "x1,y1,x2,y2",
                                          "utm_x,utm_y,gps_lon,gps_lat",
                                          "x_utm,x_gps,y_utm,y_gps",
                                          "start_x,end_y",
                                          "x,y,x,y",
                                          "maximum,minimum",
                                          "Breite,L\xC3\xA4nge",
                                          "coord,point",
                                          "vx,vy",
                                          ""};
    for (size_t i = 0; i < sizeof headers / sizeof headers[0]; i++)
        CHECK_MSG(strcmp(choose(headers[i]), "?") == 0, "%s: %s", headers[i], choose(headers[i]));
}

TEST(plain_headings_precede_others_and_are_then_not_obvious)
{
    CHECK_STR(choose("lon,lat,x,y"), "3,4");
    CHECK_STR(choose("utm_x,utm_y,lon,lat"), "3,4");
    CHECK_STR(choose("x,y,x_m,y_m"), "1,2");
    CHECK_STR(choose("easting,northing,lng,lat"), "3,4");
}
