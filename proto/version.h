/* version.h - the version of this project: of the daemon, the programs and both libraries. */
#pragma once

#define DELAUNAY_VERSION "1.0.0"
#define DELAUNAY_VERSION_NUMBER 10000 /* 10000 major + 100 minor + patch */
