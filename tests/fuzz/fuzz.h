/*
 * Entry points of the fuzz targets: each takes bytes as a stranger might send them, runs them
 * through the code that reads them for real, and checks what the headers promise about the outcome.
 * The same functions serve libFuzzer (driver.c) and the test that repeats the committed corpus
 * (tests/unit/test_fuzz_corpus.c).
 *
 * A broken promise ends the process with abort(): under libFuzzer the input is then kept, in the
 * test the program fails. Nothing is kept between calls; any number may follow each other.
 */
#ifndef ORL_TESTS_FUZZ_H
#define ORL_TESTS_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <jansson.h>

#include <oriel/error.h>
#include <oriel/vec.h>

/* Return true when the bytes were accepted: a scene was parsed, a map opened, ... */
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
bool fuzz_guard(const uint8_t *data, size_t size);
bool fuzz_token(const uint8_t *data, size_t size);

/* ---- For the targets (promise.c) ---------------------------------------------------------------
 */

/* Aborts, with the promise that was broken, unless it holds. */
#define FUZZ_PROMISE(holds) fuzz_promise((holds), #holds, __FILE__, __LINE__)
void fuzz_promise(bool holds, const char *what, const char *file, int line);

/*
 * What every failure promises: a code of the enum that the error repeats, a message, terminated
 * texts, and that the HTTP layer can make a problem document of it.
 */
/* Of files that name a scene's: what rif.h and frads.h say. */
void fuzz_check_project(const json_t *project);
void fuzz_check_error(int code, const struct orl_error *err);

/* A sky that can be computed with: finite, nowhere negative. */
struct orl_daylight;
struct orl_description;
void fuzz_check_daylight(const struct orl_daylight *daylight);

void fuzz_check_finite(struct orl_vec3 v);
void fuzz_check_unit(struct orl_vec3 v);
/* Materials that there are, unit normals, finite corners. */
void fuzz_check_surfaces(const struct orl_description *description);

#endif
