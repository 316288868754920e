/* geojson_file_test.c - only the geometries of a GeoJSON text are read, wherever its members are. */
#include "clients/files/geojson_file.h"

#include <math.h>
#include <string.h>

#include "tests/clients/cli.h"
#include "tests/test.h"

static struct points_file file;
static struct table_fields fields;
static struct geojson_notes notes;

static bool read_text(const char *text, bool all, bool skip_bad)
{
    points_file_free(&file);
    memset(&fields, 0, sizeof fields);
    file.skip_bad = skip_bad;
    fields.all = all;
    return geojson_text_read(&file, text, strlen(text), &fields, &notes);
}

/* The points as text, each `x,y` or with values `x,y:v:v`. */
static const char *points(void)
{
    static char text[2000];
    size_t n = 0;
    text[0] = '\0';
    for (size_t i = 0; i < file.n; i++) {
        n += (size_t)snprintf(text + n, sizeof text - n, "%s%g,%g", i > 0 ? " " : "",
                              file.xy[2 * i], file.xy[2 * i + 1]);
        for (size_t k = 0; k < file.fields; k++)
            n +=
                (size_t)snprintf(text + n, sizeof text - n, ":%g", file.value[file.fields * i + k]);
    }
    return text;
}

static void expect(const char *text, const char *want)
{
    CHECK_MSG(read_text(text, false, false), "%s: %s", text, file.fault);
    CHECK_STR(points(), want);
}

static void refuse(const char *text, uint64_t line, const char *fault)
{
    CHECK_MSG(!read_text(text, false, false), "%s", text);
    CHECK_STR(file.fault, fault);
    CHECK(file.line == line);
}

#define POINT(x, y) "{\"type\":\"Point\",\"coordinates\":[" #x "," #y "]}"
#define FEATURE(properties, geometry)                                                              \
    "{\"type\":\"Feature\",\"properties\":" properties ",\"geometry\":" geometry "}"

TEST(points_beside_the_geometry_are_not_read)
{
    expect(FEATURE("{\"centroid\":" POINT(9, 9) "}", POINT(0, 0)), "0,0");
    expect("{\"type\":\"Feature\",\"centre\":" POINT(9, 9) ",\"geometry\":" POINT(1, 2) "}", "1,2");
    expect(
        "{\"type\":\"FeatureCollection\",\"metadata\":{\"features\":[" POINT(
            9, 9) "]},\"origin\":" POINT(8, 8) ",\"features\":[" FEATURE("null", POINT(1, 2)) "]}",
        "1,2");
    expect("{\"type\":\"Point\",\"bbox\":[1,2,1,2],\"coordinates\":[1,2],\"x\":" POINT(7, 7) "}",
           "1,2");
    expect(FEATURE("{\"geometry\":" POINT(9, 9) ",\"geometries\":[" POINT(9, 9) "]}", POINT(3, 4)),
           "3,4");
    points_file_free(&file);
}

TEST(members_may_be_in_any_order)
{
    expect("{\"geometry\":{\"coordinates\":[1,2],\"type\":\"Point\"},\"properties\":{},\"type\":"
           "\"Feature\"}",
           "1,2");
    expect("{\"features\":[{\"geometry\":{\"coordinates\":[[1,2],[3,4]],\"type\":\"MultiPoint\"},"
           "\"type\":\"Feature\"}],\"type\":\"FeatureCollection\"}",
           "1,2 3,4");
    expect("{\"geometries\":[" POINT(1, 2) "],\"type\":\"GeometryCollection\"}", "1,2");
    points_file_free(&file);
}

TEST(collections_may_be_nested_and_follow_one_another)
{
    expect("{\"type\":\"GeometryCollection\",\"geometries\":[" POINT(
               1, 2) ",{\"type\":\"GeometryCollection\",\"geometries\":[" POINT(3, 4) "]}]}",
           "1,2 3,4");
    expect("{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"FeatureCollection\","
           "\"features\":[" FEATURE("{}", POINT(1, 2)) "]}," FEATURE("{}", POINT(3, 4)) "]}",
           "1,2 3,4");
    expect(POINT(1, 2) "\n" FEATURE("{}", POINT(3, 4)) "\n\x1E" POINT(5, 6) "\n", "1,2 3,4 5,6");
    expect("[" POINT(1, 2) "," FEATURE("{}", POINT(3, 4)) "]", "1,2 3,4");
    points_file_free(&file);
}

TEST(a_collection_is_no_geometry_of_a_feature)
{
    refuse(FEATURE("{}", "{\"type\":\"FeatureCollection\",\"features\":[" POINT(1, 2) "]}"), 1,
           "a geometry of a type that GeoJSON does not have");
    CHECK(file.n == 0);
    refuse(FEATURE("{}", FEATURE("{}", POINT(1, 2))), 1,
           "a geometry of a type that GeoJSON does not have");
    points_file_free(&file);
}

TEST(features_without_a_place_are_counted)
{
    expect(FEATURE("{}", "null") FEATURE("{}", POINT(1, 2)) "{\"type\":\"Feature\","
                                                            "\"properties\":{}}"
                                                            "{\"type\":\"Point\",\"coordinates\":[]"
                                                            "}",
           "1,2");
    CHECK(notes.nowhere == 3);
    points_file_free(&file);
}

TEST(what_is_no_geojson_is_refused_and_not_left_out)
{
    refuse("{\"type\":\"Topology\",\"objects\":{}}", 1,
           "an object of a type that GeoJSON does not have");
    refuse("{\"x\":1,\"y\":2}", 1, "an object without a type that GeoJSON has");
    refuse("[[1,2],[3,4]]", 1, "a value where GeoJSON has an object");
    refuse("\n{\"type\":\"Feature\",\n\"geometry\":[1,2]}", 3,
           "a value where GeoJSON has an object");
    refuse(POINT(1, 2) "\n" POINT(3, 4) "]", 2, "not GeoJSON");
    refuse("{\"type\":\"FeatureCollection\",\"features\":" POINT(3, 4) "}", 1, "not GeoJSON");
    CHECK(!geojson_text_read(&file, POINT(1, 2) "\0" POINT(3, 4), 2 * sizeof POINT(1, 2) - 1,
                             &fields, &notes));
    points_file_free(&file);
}

TEST(a_member_that_counts_must_not_occur_twice)
{
    refuse("{\"type\":\"Point\",\"coordinates\":[1,2],\"coordinates\":[3,4]}", 1,
           "an object has the member coordinates twice");
    refuse("{\"type\":\"Feature\",\"geometry\":null,\n\"geometry\":" POINT(1, 2) "}", 2,
           "an object has the member geometry twice");
    expect("{\"type\":\"Point\",\"a\":1,\"a\":2,\"coordinates\":[1,2]}", "1,2");
    points_file_free(&file);
}

TEST(bad_positions_can_be_skipped_one_by_one)
{
    const char *text = "{\"type\":\"MultiPoint\",\"coordinates\":[[1,2],[3],[\"4\",5],[null,6],7,"
                       "[[8,9]],[10,11]]}";
    refuse(text, 1, "a position needs x and y");
    CHECK(read_text(text, false, true));
    CHECK_STR(points(), "1,2 10,11");
    CHECK(file.skipped == 5);
    CHECK_STR(file.skip[1].fault, "not a number");
    points_file_free(&file);
}

/* A collection with the member crs, before its features or behind them. */
#define NAMED(name) "\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"" name "\"}}"

TEST(a_member_crs_says_that_coordinates_are_no_degrees)
{
    static const char *const degrees[] = {
        "{\"type\":\"FeatureCollection\",\"features\":[" POINT(1, 2) "]}",
        "{\"type\":\"FeatureCollection\"," NAMED(
            "urn:ogc:def:crs:OGC:1.3:CRS84") ",\"features\":[" POINT(1, 2) "]}",
        "{" NAMED("EPSG:4326") ",\"features\":[" POINT(1, 2) "]}",
        "{\"type\":\"FeatureCollection\",\"crs\":null,\"features\":[" POINT(1, 2) "]}",
        "{\"type\":\"Point\",\"coordinates\":[1,2]}"};
    static const char *const projected[] = {
        "{\"type\":\"FeatureCollection\"," NAMED(
            "urn:ogc:def:crs:EPSG::32629") ",\"features\":[" POINT(1, 2) "]}",
        "{\"type\":\"FeatureCollection\",\"features\":[" POINT(1, 2) "]," NAMED("EPSG:14326") "}",
        "{\"type\":\"FeatureCollection\",\"crs\":{\"type\":\"link\"},\"features\":[" POINT(1,
                                                                                           2) "]}"};
    for (size_t i = 0; i < sizeof degrees / sizeof degrees[0]; i++) {
        expect(degrees[i], "1,2");
        CHECK_MSG(!notes.projected, "%s", degrees[i]);
    }
    for (size_t i = 0; i < sizeof projected / sizeof projected[0]; i++) {
        expect(projected[i], "1,2");
        CHECK_MSG(notes.projected, "%s", projected[i]);
    }
    points_file_free(&file);
}

TEST(heights_that_are_missing_are_counted)
{
    expect("{\"type\":\"MultiPoint\",\"coordinates\":[[0,0,1.5],[1,0],[0,1,null],[2,2,NaN],"
           "[3,3,1e999],[4,4,-2,17]]}",
           "0,0:1.5 1,0:nan 0,1:nan 2,2:nan 3,3:nan 4,4:-2");
    CHECK(notes.heights && fields.missing[0] == 4 && notes.more == 1);
    CHECK_STR(fields.name[0], "z");
    points_file_free(&file);
}

#define TOWNS                                                                                      \
    FEATURE("{\"name\":\"a\",\"pop\":5,\"rank\":null}", POINT(1, 2))                               \
    FEATURE("{\"pop\":7,\"rank\":2,\"name\":\"b\"}", POINT(3, 4))                                  \
    FEATURE("{\"name\":\"c\",\"pop\":\"many\"}", POINT(5, 6))

TEST(properties_of_numbers_become_fields_on_request)
{
    CHECK(read_text(TOWNS, true, false));
    CHECK_STR(points(), "1,2:5:nan 3,4:7:2 5,6:nan:nan");
    CHECK_STR(fields.name[0], "pop");
    CHECK_STR(fields.name[1], "rank");
    CHECK(fields.missing[0] == 1 && fields.missing[1] == 2);
    CHECK_STR(notes.unused, "name");
    expect(TOWNS, "1,2 3,4 5,6");
    CHECK_STR(notes.unused, "name, pop, rank");
    points_file_free(&file);
}

TEST(a_property_may_have_the_heights_unless_there_are_third_coordinates)
{
    expect(FEATURE("{\"elevation\":12.5,\"n\":1}", POINT(1, 2)), "1,2:12.5");
    CHECK_STR(fields.name[0], "z");
    CHECK_STR(notes.property, "elevation");
    CHECK_STR(notes.unused, "n");
    expect(FEATURE("{\"elevation\":12.5}", "{\"type\":\"Point\",\"coordinates\":[1,2,3]}"),
           "1,2:3");
    CHECK_STR(notes.unused, "elevation");
    CHECK(read_text(FEATURE("{\"z\":4}", "{\"type\":\"Point\",\"coordinates\":[1,2,3]}"), true,
                    false));
    CHECK_STR(points(), "1,2:3:4");
    CHECK_STR(fields.name[1], "z_2");
    points_file_free(&file);
}

TEST(many_properties_are_listed_in_short)
{
    static char text[20000];
    size_t n = (size_t)sprintf(
        text, "{\"type\":\"Feature\",\"geometry\":" POINT(1, 2) ",\"properties\":{\"p\":1");
    for (int i = 0; i < 400; i++)
        n += (size_t)sprintf(text + n, ",\"property_%d\":%d", i, i);
    sprintf(text + n, "}}");
    expect(text, "1,2");
    CHECK(strlen(notes.unused) < 400 && strstr(notes.unused, ", ...") != NULL);
    CHECK(read_text(text, true, false));
    CHECK(file.fields == FIELDS_MOST && fields.n == FIELDS_MOST && file.value[63] == 62);
    points_file_free(&file);
}

TEST(load_says_what_of_geojson_is_not_used)
{
    char command[200];
    int status;
    cli_begin();
    cli_write("t.geojson",
              TOWNS FEATURE("{\"elevation\":3}", "{\"type\":\"Point\",\"coordinates\":[7,8]}")
                  FEATURE("{}", "null"));
    snprintf(command, sizeof command, "load t %s --fields", cli_path("t.geojson"));
    const char *out = cli_run(&status, command);
    CHECK_MSG(status == 0, "%s", out);
    CHECK_MSG(
        strstr(out, ": using x y of the coordinates, of the properties pop rank z=elevation\n"),
        "%s", out);
    CHECK_MSG(strstr(out, ": properties not used: name\n") != NULL, "%s", out);
    CHECK_MSG(strstr(out, ": 1 without a place (a geometry that is null or empty)\n") != NULL, "%s",
              out);
    cli_expect("fields t", "OK 3\npop 2 5 7\nrank 1 2 2\nz 1 3 3\n");
    cli_finish();
}
