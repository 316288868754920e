/* xml_scan.h - a scanner of XML text [XML 1.0] that is in memory: the next tag, with the text before it. It knows no entities and no
 * name spaces, and does not check that tags match. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct xml_part {
    const char *text;
    size_t len;
};

struct xml_scan {
    const char *p, *end;
    uint64_t line; /* of p, from 1 */
};

struct xml_tag {
    bool opens, closes;        /* <a>: opens; </a>: closes; <a/>: both */
    struct xml_part name;      /* without the prefix of its name space */
    struct xml_part attribute; /* all of them, as they are written */
    struct xml_part before;    /* the text since the last tag, CDATA section or comment */
    uint64_t line;             /* in which the tag begins */
};

/* The next tag; comments, processing instructions, declarations and CDATA sections are passed. 0: there is none; -1: something is
 * not closed before the end of the text. */
int xml_next(struct xml_scan *x, struct xml_tag *tag);

/* The value of an attribute; false if the tag has none of that name. */
bool xml_attribute(const struct xml_tag *tag, const char *name, struct xml_part *value);

bool xml_is(struct xml_part part, const char *text);
