/* Facts about the machine from the kernel: the id of the current boot, and how often memory ran
 * out. */
#ifndef ORL_SERVER_HEALTH_KERNEL_FACTS_H
#define ORL_SERVER_HEALTH_KERNEL_FACTS_H

#include <stdint.h>

enum { ORL_BOOT_ID = 40 };

/* Writes the id of this boot; "" if the kernel does not report it. */
void orl_kernel_boot_id(char ret_id[ORL_BOOT_ID]);
/* Returns the number of processes that the kernel has killed for memory since the boot, including
 * those killed by limits of control groups. UINT64_MAX if the kernel does not report it. */
uint64_t orl_kernel_oom_kills(void);

#endif
