/* Groups of processes whose memory the kernel limits (cgroups, version 2 or 1). */
#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "bench/scale.h"

/* Writes one of the group's files; returns false if it is missing or rejects the value. */
static bool write_file(const char *group, const char *name, const char *text)
{
    char path[2 * BENCH_PATH];
    snprintf(path, sizeof path, "%s/%s", group, name);
    const int file = open(path, O_WRONLY | O_CLOEXEC);
    const bool written = file >= 0 && write(file, text, strlen(text)) == (ssize_t)strlen(text);
    if (file >= 0)
        close(file);
    return written;
}

static double read_file(const char *group, const char *name)
{
    char path[2 * BENCH_PATH];
    double value = 0;
    snprintf(path, sizeof path, "%s/%s", group, name);
    FILE *in = fopen(path, "r");
    if (in && fscanf(in, "%lf", &value) != 1)
        value = 0;
    if (in)
        fclose(in);
    return value;
}

/*
 * Finds the parent folder of a new group. Version 1: within this process's group. Version 2: beside
 * it, since only groups without processes can be divided.
 */
static bool find_place(char ret_place[BENCH_PATH])
{
    char line[BENCH_PATH], own[2][BENCH_PATH] = {"", ""}, path[BENCH_PATH];
    FILE *in = fopen("/proc/self/cgroup", "r");
    while (in && fgets(line, sizeof line, in)) {
        line[strcspn(line, "\n")] = '\0';
        if (sscanf(line, "%*d:memory:%400s", path) == 1)
            snprintf(own[0], BENCH_PATH, "/sys/fs/cgroup/memory%.400s", path);
        if (strncmp(line, "0::", 3) == 0)
            snprintf(own[1], BENCH_PATH, "/sys/fs/cgroup%.400s", line + 3);
    }
    if (in)
        fclose(in);
    if (own[0][0])
        snprintf(ret_place, BENCH_PATH, "%s", own[0]);
    else if (own[1][0])
        snprintf(ret_place, BENCH_PATH, "%s", dirname(own[1]));
    return own[0][0] || own[1][0];
}

bool scale_group_make(double limit_bytes, char ret_group[BENCH_PATH])
{
    char place[BENCH_PATH], bytes[32];
    if (!find_place(place))
        return false;
    const int length = snprintf(ret_group, BENCH_PATH, "%s/oriel-bench-%d", place, (int)getpid());
    if (length < 0 || length >= BENCH_PATH || mkdir(ret_group, 0755) != 0)
        return false;
    snprintf(bytes, sizeof bytes, "%.0f", limit_bytes);
    if (write_file(ret_group, "memory.max", bytes) ||
        write_file(ret_group, "memory.limit_in_bytes", bytes))
        return true;
    scale_group_remove(ret_group);
    return false;
}

bool scale_group_join(const char *group)
{
    return write_file(group, "cgroup.procs", "0");
}

double scale_group_peak(const char *group)
{
    return read_file(group, "memory.peak") + read_file(group, "memory.max_usage_in_bytes");
}

void scale_group_remove(const char *group)
{
    const struct timespec pause = {0, 100000000};
    for (int attempt = 0; attempt < 20 && rmdir(group) != 0 && errno == EBUSY; attempt++)
        nanosleep(&pause, NULL);
}

void scale_forget_maps(const char *maps)
{
    const char *const argv[] = {"sh", "-c",
                                "sync -f \"$0\"/*.opm; for f in \"$0\"/*.opm; do dd "
                                "if=\"$f\" iflag=nocache count=0 status=none; done",
                                maps, NULL};
    if (bench_spawn(argv, NULL, NULL, NULL, NULL) != 0)
        bench_fail("the maps' pages cannot be dropped", NULL);
}
