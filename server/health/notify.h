/*
 * Notifications to systemd if it started the daemon: ready, stopping, and periodically that the
 * loop still runs (sd_notify(3), by its socket alone).
 */
#ifndef ORL_SERVER_HEALTH_NOTIFY_H
#define ORL_SERVER_HEALTH_NOTIFY_H

/* Sends a state such as "READY=1" or "STOPPING=1". Does nothing if systemd does not listen. */
void orl_notify(const char *state);
/* Sends "WATCHDOG=1" if systemd expects it. Called every second. */
void orl_notify_alive(void);

#endif
