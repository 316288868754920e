/* systemd.h - the protocols of a service manager, sd_notify(3) and sd_listen_fds(3), without its library.
 * If the environment names no such manager, these functions do nothing. */
#pragma once

/* Writes the listening stream sockets that were passed to the process into fd, at most `most`; they are
 * non-blocking, closed on exec, and the caller's. Returns how many. To be called once. */
int systemd_sockets(int *fd, int most);

/* Sends a state such as "READY=1". An unreachable manager is no error. */
void systemd_notify(const char *state);
