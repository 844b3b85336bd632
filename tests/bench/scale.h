/*
 * `make bench-scale`: what grows how. Photons from a million to fifty: the time and the memory that
 * making their map takes, its bytes, the time of a look-up in it; threads; and a view from the
 * largest map, as it is and in less memory than the map takes.
 *
 * Every build and every view runs in a process of its own, whose peak of resident memory is its
 * own. The process of the limited view is in a group of processes (cgroup) whose memory, pages of
 * files included, the kernel limits; of both views the map's pages are dropped beforehand, so that
 * they read it from the disk, and what is read counts as theirs.
 *
 * Where making a group is not allowed, a thread beside the view instead sends pages of the mapped
 * file back to the disk (MADV_PAGEOUT) whenever more than nine tenths of the limit are resident,
 * looking every 2 ms; the peak may then be above the limit, which is printed, as is which of the
 * two ways it was. (RLIMIT_DATA would count what is merely reserved, and nothing that is mapped.)
 */
#ifndef ORL_TESTS_BENCH_SCALE_H
#define ORL_TESTS_BENCH_SCALE_H

#include "bench/office.h"

/* What a build tells, on its standard output. */
struct scale_build {
    double seconds, rays_per_s; /* rays_per_s: of as many threads, measured beside */
    double stored, bytes;
    double peak_bytes; /* resident, of the process */
};

/* What a view tells. */
struct scale_view {
    double seconds;
    double peak_bytes;  /* resident, of the process */
    double paged_bytes; /* sent back to the disk, where the kernel does not do it */
    bool by_kernel;     /* who limits; then peak_bytes is of the group */
};

/* Runs this program again, to build a map of so many photons in a folder of maps, or to render a
 * view from it to a file; limit_bytes 0: none. */
void scale_build(const struct office *office, const char *maps, uint64_t photons, uint32_t threads,
                 struct scale_build *ret_build);
void scale_render(const struct office *office, const char *maps, uint64_t photons,
                  double limit_bytes, const char *image, struct scale_view *ret_view);

/* The other side of these: argv from the word "build" or "render" on; returns the exit status. */
int scale_child(int argc, char **argv);

/* Keeps resident memory below that, as far as mapped photon maps let it, until the process ends. */
void scale_start_pager(double most_bytes);
/* How many bytes the pager has sent back. */
double scale_paged(void);

/* A group of so much memory, without members; false when that is not allowed. Joining is the
 * calling process's own. */
bool scale_group_make(double limit_bytes, char ret_group[BENCH_PATH]);
bool scale_group_join(const char *group);
double scale_group_peak(const char *group);
void scale_group_remove(const char *group);
/* Writes a folder's maps to the disk, and drops what is in memory of them. */
void scale_forget_maps(const char *maps);

/* Seconds of a look-up of 50 photons at places of photons drawn at random, in a folder's map; the
 * median. */
double scale_search(const char *maps, double extent);

#endif
