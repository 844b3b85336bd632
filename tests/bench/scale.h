/*
 * `make bench-scale`: scaling of photon maps. Measures builds of a million to fifty million photons
 * (time, memory, bytes of the map, time of a look-up), threads, and a view from the largest map,
 * without a limit and in less memory than the map.
 *
 * Every build and every view runs in a separate process, so that each has its own peak of resident
 * memory. The process of the limited view is in a group of processes (cgroup) whose memory, file
 * pages included, the kernel limits. The map's pages are dropped before both views, so that both
 * read it from the disk, and these reads count.
 *
 * If a group cannot be created, a thread beside the view instead sends pages of the mapped file
 * back to the disk (MADV_PAGEOUT) whenever more than nine tenths of the limit are resident; it
 * checks every 2 ms. The peak may then exceed the limit. The output states the peak and which
 * method was used. (RLIMIT_DATA would count reserved memory, and no mapped memory.)
 */
#ifndef ORL_TESTS_BENCH_SCALE_H
#define ORL_TESTS_BENCH_SCALE_H

#include "bench/office.h"

/* Result of a build, read from the child's standard output. */
struct scale_build {
    double seconds, rays_per_s; /* rays_per_s: rate of as many threads, measured beside the build */
    double stored, bytes;
    double peak_bytes; /* peak resident memory of the process */
};

/* Result of a view. */
struct scale_view {
    double seconds;
    double peak_bytes;  /* peak resident memory of the process */
    double paged_bytes; /* bytes sent back to the disk by the pager; 0 under a kernel limit */
    bool by_kernel;     /* true if the kernel limits; peak_bytes is then the group's */
};

/* Run this program again, to build a map of that many photons in a folder of maps, or to render a
 * view from it to a file; limit_bytes 0: no limit. */
void scale_build(const struct office *office, const char *maps, uint64_t photons, uint32_t threads,
                 struct scale_build *ret_build);
void scale_render(const struct office *office, const char *maps, uint64_t photons,
                  double limit_bytes, const char *image, struct scale_view *ret_view);

/* Child side of these: argv starts with the word "build" or "render". Returns the exit status. */
int scale_child(int argc, char **argv);

/* Keeps resident memory below that by paging out mapped photon maps, until the process ends. */
void scale_start_pager(double most_bytes);
/* Returns the bytes that the pager has sent back. */
double scale_paged(void);

/* Creates an empty group with that memory limit; returns false if this is not allowed. The calling
 * process joins by the other function. */
bool scale_group_make(double limit_bytes, char ret_group[BENCH_PATH]);
bool scale_group_join(const char *group);
double scale_group_peak(const char *group);
void scale_group_remove(const char *group);
/* Writes a folder's maps to the disk, and drops their pages from memory. */
void scale_forget_maps(const char *maps);

/* Returns the median seconds of a look-up of 50 photons at places of random photons, in a folder's
 * map. */
double scale_search(const char *maps, double extent);

#endif
