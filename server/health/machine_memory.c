#include "health/machine_memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_BYTES = 4096 };

/* ---- Capacity ------------------------------------------------------------------------------- */

/* Reads a limit. "max", or more than any machine has, means no limit. */
static uint64_t read_limit(const char *path)
{
    char text[64] = "";
    FILE *file = fopen(path, "re");
    if (!file)
        return UINT64_MAX;
    const char *line = fgets(text, sizeof text, file);
    fclose(file);
    char *end = text;
    const unsigned long long bytes = line ? strtoull(text, &end, 10) : 0;
    return end == text || bytes >= 1ULL << 60 ? UINT64_MAX : bytes;
}

/* Returns the smallest limit of the group and the groups above it. */
static uint64_t least_above(const char *folder, const char *group, const char *file)
{
    char path[PATH_BYTES], above[PATH_BYTES];
    uint64_t least = UINT64_MAX;
    snprintf(above, sizeof above, "%s", group);
    for (char *slash = above + strlen(above); slash; slash = strrchr(above, '/')) {
        *slash = '\0';
        if (snprintf(path, sizeof path, "%s%s/%s", folder, above, file) < (int)sizeof path) {
            const uint64_t limit = read_limit(path);
            least = limit < least ? limit : least;
        }
    }
    return least;
}

static bool has_memory(const char *controllers)
{
    const char *at = strstr(controllers, "memory");
    return at && (at == controllers || at[-1] == ',') && (at[6] == ',' || at[6] == '\0');
}

uint64_t orl_memory_cgroup_limit(const char *groups, const char *mount)
{
    uint64_t least = UINT64_MAX;
    char *copy = strdup(groups), *save = NULL;
    /* Version 1 has lines "4:memory:/path", version 2 "0::/path"; both may be present. */
    for (char *line = copy ? strtok_r(copy, "\n", &save) : NULL; line;
         line = strtok_r(NULL, "\n", &save)) {
        char *controllers = strchr(line, ':');
        char *group = controllers ? strchr(++controllers, ':') : NULL;
        uint64_t limit = UINT64_MAX;
        char folder[PATH_BYTES];
        if (!group)
            continue;
        *group++ = '\0';
        if (*controllers == '\0') {
            limit = least_above(mount, group, "memory.max");
        } else if (has_memory(controllers)) {
            snprintf(folder, sizeof folder, "%s/memory", mount);
            limit = least_above(folder, group, "memory.limit_in_bytes");
        }
        least = limit < least ? limit : least;
    }
    free(copy);
    return least;
}

static uint64_t read_groups(void)
{
    char text[8192] = "";
    FILE *file = fopen("/proc/self/cgroup", "re");
    if (!file)
        return UINT64_MAX;
    const size_t n = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    text[n] = '\0';
    return orl_memory_cgroup_limit(text, "/sys/fs/cgroup");
}

static uint64_t read_available(void)
{
    char line[128];
    unsigned long long kb = 0;
    FILE *file = fopen("/proc/meminfo", "re");
    while (file && kb == 0 && fgets(line, sizeof line, file))
        if (strncmp(line, "MemAvailable:", 13) == 0)
            kb = strtoull(line + 13, NULL, 10);
    if (file)
        fclose(file);
    return kb > 0 ? (uint64_t)kb << 10 : UINT64_MAX;
}

uint64_t orl_memory_resident(void)
{
    char text[128] = "";
    unsigned long pages[3] = {0}; /* total, resident, shared */
    FILE *statm = fopen("/proc/self/statm", "re");
    const char *line = statm ? fgets(text, sizeof text, statm) : NULL;
    if (statm)
        fclose(statm);
    if (!line)
        return 0;
    char *at = text;
    for (int i = 0; i < 3; i++)
        pages[i] = strtoul(at, &at, 10);
    if (pages[1] < pages[2])
        return 0;
    return (uint64_t)(pages[1] - pages[2]) * (uint64_t)sysconf(_SC_PAGESIZE);
}

void orl_memory_open(struct orl_memory *memory, uint64_t bytes)
{
    const uint64_t groups = read_groups(), available = read_available();
    memory->idle = orl_memory_resident();
    memory->capacity = groups == UINT64_MAX ? groups : groups - groups / 10;
    if (available < memory->capacity)
        memory->capacity = available;
    if (bytes > 0)
        memory->capacity = bytes;
}

/* ---- Promises ------------------------------------------------------------------------------- */

uint64_t orl_memory_available(const struct orl_memory *memory)
{
    const uint64_t resident = orl_memory_resident(), promised = memory->idle + memory->jobs;
    const uint64_t held = (resident > promised ? resident : promised) + memory->checks;
    return held < memory->capacity ? memory->capacity - held : 0;
}

uint64_t orl_memory_limit(const struct orl_memory *memory)
{
    return memory->idle < memory->capacity ? memory->capacity - memory->idle : 0;
}

void orl_memory_reserve(struct orl_memory *memory, uint64_t bytes)
{
    if (memory->jobs == 0)
        memory->idle = orl_memory_resident();
    memory->jobs += bytes;
    memory->wanted = 0;
}

void orl_memory_release(struct orl_memory *memory, uint64_t bytes)
{
    memory->jobs -= bytes;
}
