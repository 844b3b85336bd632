/*
 * `make bench-scale`: what grows how. Photons from a million to fifty: the time and the memory that
 * making their map takes, its bytes, the time of a look-up in it; threads; and a view from the
 * largest map, as it is and in less memory than the map takes.
 *
 * Every build and every view runs in a process of its own, whose peak of resident memory is its
 * own. The memory of a process cannot be limited without privileges (RLIMIT_DATA counts what is
 * merely reserved and nothing that is mapped): instead a thread beside the view sends pages of the
 * mapped file back to the disk (MADV_PAGEOUT) whenever more than nine tenths of the limit are
 * resident. What is printed is the peak that it has seen, at a look every 2 ms, and whether that
 * kept to the limit; reading pages back costs what the machine's page cache makes of it.
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
    double paged_bytes; /* sent back to the disk */
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

/* Seconds of a look-up of 50 photons at places of photons drawn at random, in a folder's map; the
 * median. */
double scale_search(const char *maps, double extent);

#endif
