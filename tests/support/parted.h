/*
 * Jobs run in one process and in parts: a desk with a room's documents, and checks that both give
 * equal results.
 */
#ifndef ORL_TESTS_SUPPORT_PARTED_H
#define ORL_TESTS_SUPPORT_PARTED_H

#include <jansson.h>

#include "support/cli.h"

/* Documents of the desk, by kind of job. */
extern const char *const parted_render; /* two views, 300 sensors, photon maps */
extern const char *const parted_skies;  /* five skies */
extern const char *const parted_middle; /* five skies, a second of work each */
extern const char *const parted_long;   /* five skies, two seconds of work each */
extern const char *const parted_goal;   /* an accuracy goal, in rounds, 40 sensors */
extern const char *const parted_annual; /* 150 sensors, two days of weather */
extern const char *const parted_study;  /* two techniques, three seeds */
extern const char *const parted_panel;  /* a matrix of slats, to an accuracy goal, in rounds */
extern const char *const parted_tree;   /* a tensor tree of slats */
extern const char *const parted_colors; /* a tensor tree of slats, in colour */

/* cmocka's set-up and tear-down. */
int parted_set_up(void **state);

/* Runs a document with further options (NULL: none; up to eight words), into a subfolder of the
 * desk. Fails the test if the command fails. */
void parted_run(struct cli_desk *desk, const char *document, const char *output,
                const char *const *options);

/* Fails the test, and names the file, unless the folders of two runs have equal results: all files
 * but result.json and maps byte for byte, and result.json without times, counts and costs. Of a
 * study only study.json is compared, since the other files repeat its numbers and times. */
void parted_assert_same(const struct cli_desk *desk, const char *one, const char *other);

/* Runs a document in one process and with those options, and expects equal results. */
void parted_compare(struct cli_desk *desk, const char *document, const char *const *options);

#endif
