/* `orield scrub` and `orield backup`: check or copy the stored data. */
#ifndef ORL_SERVER_MAINTENANCE_STORE_COMMAND_H
#define ORL_SERVER_MAINTENANCE_STORE_COMMAND_H

/* Runs the command; argv[0] is the verb. Returns the process's status. */
int orl_store_command(int argc, char **argv);

#endif
