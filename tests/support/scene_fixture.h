/*
 * Scenes of tests, and parts of scenes, as Radiance files in tests/fixtures/scenes: rooms and what
 * stands in them, by name. A file's head says what it shows, and which materials it expects.
 *
 * Texts belong to this module and live until the process ends. Call it from one thread. Everything
 * here fails the running test on error.
 */
#ifndef ORL_TESTS_SUPPORT_SCENE_FIXTURE_H
#define ORL_TESTS_SUPPORT_SCENE_FIXTURE_H

/* Returns the text of tests/fixtures/scenes/NAME.rad. */
const char *scene_fixture(const char *name);

/* Returns the scene of these texts, in order; the last argument is NULL. */
const char *scene_join(const char *first, ...) __attribute__((sentinel));

#endif
