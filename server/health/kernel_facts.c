#include "health/kernel_facts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/open.h>

void orl_kernel_boot_id(char ret_id[ORL_BOOT_ID])
{
    ret_id[0] = '\0';
    FILE *file = orl_fopen_regular("/proc/sys/kernel/random/boot_id", 'r');
    if (file && fgets(ret_id, ORL_BOOT_ID, file))
        ret_id[strcspn(ret_id, "\n")] = '\0';
    if (file)
        fclose(file);
}

uint64_t orl_kernel_oom_kills(void)
{
    static const char name[] = "oom_kill ";
    uint64_t kills = UINT64_MAX;
    char line[128];
    FILE *file = orl_fopen_regular("/proc/vmstat", 'r');
    while (file && kills == UINT64_MAX && fgets(line, sizeof line, file))
        if (strncmp(line, name, sizeof name - 1) == 0)
            kills = strtoull(line + sizeof name - 1, NULL, 10);
    if (file)
        fclose(file);
    return kills;
}
