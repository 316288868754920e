/* repair.h - the commands delaunayd --check DIR and --repair DIR. They report on standard output and return the exit status:
 * 0 if the directory is good (after the repair), 1 if not. */
#pragma once

int repair_check(const char *path);
int repair_run(const char *path);
