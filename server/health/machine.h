/* Facts about the machine from the kernel: which boot this is, and how often memory ran out. */
#ifndef ORL_SERVER_HEALTH_MACHINE_H
#define ORL_SERVER_HEALTH_MACHINE_H

#include <stdint.h>

enum { ORL_BOOT_ID = 40 };

/* The id of this boot; "" where the kernel does not say. */
void orl_machine_boot(char ret_id[ORL_BOOT_ID]);
/* How many processes the kernel has killed for memory since the boot, those of control groups among
 * them; UINT64_MAX where it does not say. */
uint64_t orl_machine_oom_kills(void);

#endif
