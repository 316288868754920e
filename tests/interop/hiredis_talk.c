/* hiredis_talk.c - a session through hiredis: single requests, pipelines, binary words, errors.
 *
 *     hiredis_talk PORT        exits with 0 if every reply is as expected */
#include <hiredis/hiredis.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failed;

static void check(int condition, const char *what)
{
    if (!condition) {
        fprintf(stderr, "hiredis: %s\n", what);
        failed = 1;
    }
}

static void expect(redisContext *c, redisReply *r, int type, const char *text, const char *what)
{
    if (r == NULL)
        fprintf(stderr, "hiredis: %s: %s\n", what, c->errstr);
    check(r != NULL && r->type == type &&
              (text == NULL || strncmp(r->str, text, strlen(text)) == 0),
          what);
    freeReplyObject(r);
}

static void converse(redisContext *c)
{
    double xy[] = {0, 0, 4, 0, 4, 4, 0, 4, 2, 2};
    expect(c, redisCommand(c, "PING"), REDIS_REPLY_STATUS, "PONG", "PING");
    expect(c, redisCommand(c, "LOADB h 5 %b", xy, sizeof xy), REDIS_REPLY_STATUS,
           "OK first=0 added=5 coincident=0", "LOADB with its points as a word");
    expect(c, redisCommand(c, "LOCATE h 1 1"), REDIS_REPLY_ERROR,
           "UNTRIANGULATED TRIANGULATE the set first", "an error");
    expect(c, redisCommand(c, "TRIANGULATE h"), REDIS_REPLY_STATUS, NULL, "TRIANGULATE");
    redisReply *r = redisCommand(c, "LISTS h");
    check(r != NULL && r->type == REDIS_REPLY_ARRAY && r->elements == 5 &&
              strcmp(r->element[0]->str, "4 0 1 2 3") == 0,
          "LISTS");
    freeReplyObject(r);
    r = redisCommand(c, "TRIANGLES h BINARY");
    check(r != NULL && r->type == REDIS_REPLY_STRING && r->len == 48, "TRIANGLES BINARY");
    freeReplyObject(r);
}

static void pipeline(redisContext *c)
{
    redisReply *r;
    for (int i = 0; i < 10000; i++)
        redisAppendCommand(c, "NEAREST h %d 0.5", i % 5);
    for (int i = 0; i < 10000 && !failed; i++) {
        check(redisGetReply(c, (void **)&r) == REDIS_OK && r->type == REDIS_REPLY_ARRAY &&
                  r->elements == 1,
              "a pipeline");
        freeReplyObject(r);
    }
    expect(c, redisCommand(c, "DROP h"), REDIS_REPLY_STATUS, "OK", "DROP");
}

int main(int argc, char **argv)
{
    redisContext *c = redisConnect("127.0.0.1", argc > 1 ? atoi(argv[1]) : 6374);
    if (c == NULL || c->err != 0) {
        fprintf(stderr, "hiredis: no connection\n");
        return 1;
    }
    converse(c);
    pipeline(c);
    redisFree(c);
    return failed;
}
