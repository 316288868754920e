/* degrees.h - angles in degrees, with the same bytes on all machines: only operations that IEEE defines, none of the C library. */
#pragma once

/* How steep a plane with the slopes dx and dy is: 0 to 90. The slopes may be infinite. Errs by less than 2^-52 of itself and the least
 * double. */
double dt_degrees_steep(double dx, double dy);

/* The direction in which that plane falls, clockwise from the positive y axis, from 0 up to but not including 360; nan if it is level.
 * An infinite slope counts as 2^1024. Errs by less than 2^-52 of itself and 2^-1067. */
double dt_degrees_downhill(double dx, double dy);
