/* systemd.h - what the daemon and a service manager tell one another: sd_notify(3) and
 * sd_listen_fds(3), spoken directly. Without such a manager in the environment nothing happens. */
#ifndef SERVER_SYSTEMD_H
#define SERVER_SYSTEMD_H

/* The listening stream sockets that were handed over: at most `most` descriptors into fd, which the
 * caller owns, non-blocking and closed on exec. Returns how many. To be called once. */
int systemd_sockets(int *fd, int most);

/* Tells the manager a state, as in "READY=1". A manager that cannot be reached is no error. */
void systemd_notify(const char *state);

#endif
