/*
 * What systemd is told, where it has started the daemon: that it serves, that it stops, and every
 * now and then that the loop still turns (sd_notify(3), by its socket alone).
 */
#ifndef ORL_SERVER_HEALTH_NOTIFY_H
#define ORL_SERVER_HEALTH_NOTIFY_H

/* "READY=1", "STOPPING=1". Nothing happens where nobody listens. */
void orl_notify(const char *state);
/* To be called every second: "WATCHDOG=1", if systemd waits for that. */
void orl_notify_alive(void);

#endif
