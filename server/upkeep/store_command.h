/* `orield scrub` and `orield backup`: what is kept is looked through, or copied. */
#ifndef ORL_SERVER_UPKEEP_STORE_COMMAND_H
#define ORL_SERVER_UPKEEP_STORE_COMMAND_H

/* argv[0] is the verb. Returns the process's status. */
int orl_store_command(int argc, char **argv);

#endif
