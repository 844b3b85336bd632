/*
 * Jobs done in one piece and in parts: a desk with a room's documents, and whether both ways give
 * the same.
 */
#ifndef ORL_TESTS_SUPPORT_PARTED_H
#define ORL_TESTS_SUPPORT_PARTED_H

#include <jansson.h>

#include "support/cli.h"

/* Documents of the desk: kinds of jobs. */
extern const char *const parted_render; /* two views, 300 sensors, photon maps */
extern const char *const parted_skies;  /* five skies */
extern const char *const parted_middle; /* the same, of a second each */
extern const char *const parted_long;   /* and of two */
extern const char *const parted_goal;   /* an accuracy, in rounds, 40 sensors */
extern const char *const parted_annual; /* 150 sensors, two days of weather */
extern const char *const parted_study;  /* two techniques, three seeds */
extern const char *const parted_panel;  /* a matrix of slats, to an accuracy, in rounds */
extern const char *const parted_tree;   /* a tree of them */
extern const char *const parted_colors; /* the same, in colour */

/* For cmocka. */
int parted_set_up(void **state);

/* Runs a document with those options besides (NULL: none; up to eight words), into a folder of the
 * desk. Fails the test where the command fails. */
void parted_run(struct cli_desk *desk, const char *document, const char *output,
                const char *const *options);

/* Whether the folders of two runs hold the same: all files but result.json and maps byte for byte,
 * and of result.json what is no time, count or cost; of a study's files study.json alone, for the
 * others are its numbers and times once more. Fails the test, and names it. */
void parted_assert_same(const struct cli_desk *desk, const char *one, const char *other);

/* Both: in one piece, and with those options, which are to make no difference. */
void parted_compare(struct cli_desk *desk, const char *document, const char *const *options);

#endif
