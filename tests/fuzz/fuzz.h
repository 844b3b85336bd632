/*
 * Entry points of the fuzz targets. Each target takes bytes as an untrusted client might send
 * them, runs the production code that reads them, and checks what the headers promise. libFuzzer
 * (driver.c) and the corpus test (tests/unit/test_fuzz_corpus.c) call the same functions.
 *
 * A broken promise ends the process with abort(): libFuzzer then keeps the input, and the test
 * program fails. Targets keep nothing between calls that changes a later outcome; they can be
 * called any number of times, in any order.
 */
#ifndef ORL_TESTS_FUZZ_H
#define ORL_TESTS_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

/* Return true if the bytes were accepted: a scene was parsed, a map opened, ... */
bool fuzz_scene(const uint8_t *data, size_t size);
bool fuzz_bsdf(const uint8_t *data, size_t size);
bool fuzz_job(const uint8_t *data, size_t size);
bool fuzz_map(const uint8_t *data, size_t size);
bool fuzz_scanner(const uint8_t *data, size_t size);
bool fuzz_sensors(const uint8_t *data, size_t size);
bool fuzz_view_file(const uint8_t *data, size_t size);
bool fuzz_weather(const uint8_t *data, size_t size);
bool fuzz_annual(const uint8_t *data, size_t size);
bool fuzz_bsdf_make(const uint8_t *data, size_t size);
bool fuzz_occupancy(const uint8_t *data, size_t size);
bool fuzz_schedule(const uint8_t *data, size_t size);
bool fuzz_measured(const uint8_t *data, size_t size);
bool fuzz_mgf(const uint8_t *data, size_t size);
bool fuzz_matrix(const uint8_t *data, size_t size);
bool fuzz_frads(const uint8_t *data, size_t size);
bool fuzz_rif(const uint8_t *data, size_t size);
bool fuzz_function(const uint8_t *data, size_t size);
bool fuzz_grid(const uint8_t *data, size_t size);
bool fuzz_hdr(const uint8_t *data, size_t size);
bool fuzz_hbjson(const uint8_t *data, size_t size);
bool fuzz_zip(const uint8_t *data, size_t size);
bool fuzz_gltf(const uint8_t *data, size_t size);
bool fuzz_mesh(const uint8_t *data, size_t size);
bool fuzz_compiled(const uint8_t *data, size_t size);
bool fuzz_framing(const uint8_t *data, size_t size);
bool fuzz_multipart(const uint8_t *data, size_t size);
bool fuzz_range(const uint8_t *data, size_t size);
bool fuzz_route(const uint8_t *data, size_t size);
bool fuzz_origin_policy(const uint8_t *data, size_t size);
bool fuzz_token(const uint8_t *data, size_t size);

/* ---- Helpers for the targets (promise.c) ----------------------------------------------------- */

/* Aborts with the text of the condition if the condition is false. */
#define FUZZ_PROMISE(holds) fuzz_promise((holds), #holds, __FILE__, __LINE__)
void fuzz_promise(bool holds, const char *what, const char *file, int line);

/* Checks a project that names a scene's files against api/project/project.h. */
void fuzz_check_project(const json_t *project);
/*
 * Checks what every failure promises: a code of the enum that the error repeats, a message,
 * terminated texts, and a problem document that the HTTP layer can build from it.
 */
void fuzz_check_error(int code, const struct orl_error *err);

/* For fuzz_check_daylight, which checks that a sky can be computed with: finite, nowhere negative.
 */
struct orl_daylight;
struct orl_parsed_scene;
void fuzz_check_daylight(const struct orl_daylight *daylight);

void fuzz_check_finite(struct orl_vec3 v);
void fuzz_check_unit(struct orl_vec3 v);
/* Checks that material indices exist, normals are unit vectors and corners are finite. */
void fuzz_check_surfaces(const struct orl_parsed_scene *parsed_scene);

#endif
