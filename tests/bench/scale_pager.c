/* A thread that limits the resident memory of mapped photon maps. */
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "bench/scale.h"

static double most;
static _Atomic double paged;

static double resident(void)
{
    unsigned long long size, pages = 0;
    FILE *in = fopen("/proc/self/statm", "r");
    if (!in || fscanf(in, "%llu %llu", &size, &pages) != 2)
        bench_fail("/proc/self/statm cannot be read", NULL);
    fclose(in);
    return (double)sysconf(_SC_PAGESIZE) * (double)pages;
}

/* Pages out every mapped photon map. */
static void page_out(void)
{
    FILE *in = fopen("/proc/self/maps", "r");
    char line[4096];
    while (in && fgets(line, sizeof line, in)) {
        char *rest;
        if (!strstr(line, ".opm"))
            continue;
        const uintptr_t low = strtoull(line, &rest, 16), high = strtoull(rest + 1, NULL, 16);
        if (madvise((void *)low, high - low, MADV_PAGEOUT) != 0)
            madvise((void *)low, high - low, MADV_DONTNEED);
    }
    if (in)
        fclose(in);
}

static void *keep_watch(void *arg)
{
    const struct timespec pause = {0, 2000000};
    (void)arg;
    for (;;) {
        const double before = resident();
        if (before > 0.9 * most) {
            page_out();
            paged = paged + fmax(before - resident(), 0);
        }
        nanosleep(&pause, NULL);
    }
    return NULL;
}

void scale_start_pager(double most_bytes)
{
    pthread_t thread;
    most = most_bytes;
    if (pthread_create(&thread, NULL, keep_watch, NULL) != 0)
        bench_fail("cannot start a thread", NULL);
    pthread_detach(thread);
}

double scale_paged(void)
{
    return paged;
}
