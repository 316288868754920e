/* sending.h - the points and lines of a file go into a set: all of them, or nothing. */
#pragma once

#include "clients/cli/file_options.h"
#include "clients/lib/delaunay_client.h"

enum { SENDING_STATUS = 400 };

/* Sends the points with their fields, with a progress bar, and declares their lines as constraints. A set that gets lines is triangulated,
 * which shows where they cross. Then nothing stays: a new set is dropped, from an old one the points are deleted. `status` becomes
 * the status line of LOADB, with what was declared. Returns the exit status, having said what is wrong, and where coincident points have
 * different values. */
int sending_send(struct file_options *r, struct delaunay_client *c, const char *set,
                 char status[SENDING_STATUS]);
