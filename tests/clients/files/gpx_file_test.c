/* gpx_file_test.c - waypoints, routes and tracks of GPX are read with their elevations. */
#include "clients/files/gpx_file.h"

#include <math.h>
#include <string.h>

#include "tests/test.h"

static struct points_file file;
static struct table_fields fields;
static struct gpx_notes notes;

static bool read_text(const char *text, bool skip_bad)
{
    points_file_free(&file);
    memset(&fields, 0, sizeof fields);
    file.skip_bad = skip_bad;
    return gpx_text_read(&file, text, strlen(text), &fields, &notes);
}

static void refuse(const char *text, uint64_t line, const char *fault)
{
    CHECK_MSG(!read_text(text, false), "%s", text);
    CHECK_STR(file.fault, fault);
    CHECK_MSG(file.line == line, "%ju", (uintmax_t)file.line);
}

TEST(gpx_points_of_all_kinds_are_read_with_their_elevations)
{
    char how[100];
    CHECK(read_text("\xEF\xBB\xBF<?xml version='1.0'?>\n<!DOCTYPE gpx [<!ELEMENT a (b)>]>\n"
                    "<!-- <wpt lat='9' lon='9'/> -->\n"
                    "<g:gpx xmlns:g='x'><g:wpt lat=\"1.5\" lon='-2'><g:ele> 7\n</g:ele></g:wpt>"
                    "<rte><rtept\n lon='3' lat='4'/></rte>"
                    "<trk><trkseg><trkpt lat='5' lon='6'><time>now</time><ele>-1.25</ele></trkpt>"
                    "<trkpt lat='7' lon='8'><ele>high</ele></trkpt></trkseg></trk></g:gpx>\n",
                    false));
    CHECK(file.n == 4 && file.fields == 1 && fields.n == 1);
    static const double want[4][3] = {
        {-2, 1.5, 7}, {3, 4, (double)NAN}, {6, 5, -1.25}, {8, 7, (double)NAN}};
    for (size_t i = 0; i < 4; i++) {
        CHECK(file.xy[2 * i] == want[i][0] && file.xy[2 * i + 1] == want[i][1]);
        CHECK(isnan(want[i][2]) ? isnan(file.value[i]) : file.value[i] == want[i][2]);
    }
    gpx_describe(&notes, how, sizeof how);
    CHECK_STR(how, "x=lon y=lat z=ele of 1 wpt, 1 rtept, 2 trkpt");
    CHECK_STR(fields.odd[0].text, "high");
    CHECK(fields.odd[0].line == 6);
    points_file_free(&file);
}

TEST(what_is_in_extensions_or_text_of_gpx_is_no_point)
{
    CHECK(read_text("<gpx><extensions><wpt lat='9' lon='9'/></extensions>"
                    "<wpt lat='1' lon='2'><name><![CDATA[<wpt lat='9' lon='9'>]]></name>"
                    "<extensions><ele>9</ele><rtept lat='9' lon='9'/></extensions>"
                    "<link><ele>8</ele></link></wpt>"
                    "<wpt name='a > b' lon='4' lat='3'/></gpx>",
                    false));
    CHECK(file.n == 2 && file.fields == 0 && file.xy[0] == 2 && file.xy[2] == 4);
    CHECK(!notes.heights && notes.points[GPX_WPT] == 2);
    points_file_free(&file);
}

TEST(bad_points_of_gpx_are_named_or_skipped)
{
    static const char text[] = "<gpx>\n<wpt lat='1' lon='2'/>\n<wpt lat='91' lon='2'/>\n"
                               "<wpt lat='x' lon='2'/><wpt lon='3'/></gpx>";
    refuse(text, 3, "a latitude is from -90 to 90");
    CHECK(read_text(text, true) && file.n == 1 && file.skipped == 3);
    CHECK_STR(file.skip[2].fault, "a point without lon and lat");
    points_file_free(&file);
}

TEST(xml_that_is_not_gpx_is_refused)
{
    refuse("<kml><wpt lat='1' lon='2'/></kml>", 1, "this XML is not GPX: its first element is kml");
    refuse("<gpx>\n<wpt lat='1' lon='2'>", 2, "not GPX: the file ends within an element");
    refuse("<gpx><wpt lat='1' lon='2", 1, "not GPX: the file ends within an element");
    refuse("<gpx></gpx></gpx>", 1, "not GPX: an element ends that has not begun");
    refuse("x", 1, "not GPX: there is no element");
    points_file_free(&file);
}
