/*
 * Measurements of goniophotometers as scans: the rows of one incident direction and one side out.
 *
 * Directions are on the hemisphere above the surface, whichever side they are on: x and y as in
 * oriel/bsdf/bsdf.h, z at least 0. Both point away from the sample. Light from the direction in
 * that passes straight, or is mirrored, leaves along (-in.x, -in.y, in.z).
 *
 * Bounds: ORL_LIMIT_MEASURED_ROWS and _SCANS. Ownership: the caller's, freed by orl_fit_data_done.
 */
#ifndef ORL_BSDF_FIT_MEASUREMENTS_MEASUREMENTS_H
#define ORL_BSDF_FIT_MEASUREMENTS_MEASUREMENTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/files.h>
#include <oriel/base/scanner.h>
#include <oriel/base/thread_pool.h>
#include <oriel/base/vec.h>
#include <oriel/bsdf/bsdf_fit.h>

struct orl_fit_row {
    float x, y, z;
    float value; /* BSDF, 1/sr; noise may make it negative */
    uint32_t file, line;
};

struct orl_fit_scan {
    bool front, transmitted;
    double theta_deg, phi_deg; /* direction in, from its side's normal; phi from +x, 0 to 360 */
    struct orl_vec3 in;
    struct orl_fit_row *rows; /* owned */
    size_t n_rows, capacity;
    size_t n_measured; /* without mirror images; set by orl_fit_sort_scans */
    uint32_t file;     /* that of the first row; set by orl_fit_sort_scans */
};

enum { ORL_FIT_NAME_MAX = 128 };

struct orl_fit_data {
    struct orl_fit_scan *scans; /* owned; in the order of the files */
    size_t n_scans, capacity;
    size_t n_rows;
    char name[ORL_FIT_NAME_MAX]; /* the sample's name; "" if no file has it */
    bool color_left_out;
    size_t last; /* index of the scan of the previous row */
};

/* Options for reading rows. */
struct orl_fit_read_options {
    bool reversed;
    double grazing_deg;
    const atomic_bool *cancel; /* borrowed; may be NULL */
};

/* Adds a file's rows. An error names the file, the line and what was expected. */
int orl_fit_read(const char *name, uint32_t file, const char *text, size_t size,
                 const struct orl_fit_read_options *options, struct orl_fit_data *data,
                 struct orl_error *err);
/* Same as orl_fit_read, for a file of the provider. */
int orl_fit_read_file(const struct orl_files *files, const char *name, uint32_t index,
                      const struct orl_fit_read_options *options, struct orl_fit_data *data,
                      struct orl_error *err);
void orl_fit_data_done(struct orl_fit_data *data); /* a zeroed struct is allowed */

/*
 * Sorts scans by component, then by direction, and applies the sample's symmetry (scans.c). If a
 * mirror leaves a direction in place, the images of its rows are added. Isotropic samples are
 * turned so that all light comes from -x; directions of equal theta are merged.
 *
 * *ret_symmetry: as requested, or derived from the incident azimuths. Returns 0, ORL_ERR_INVALID
 * (no rows; azimuths that are ambiguous or contradict the symmetry) or ORL_ERR_NOMEM.
 */
int orl_fit_sort_scans(struct orl_fit_data *data, enum orl_bsdf_fit_symmetry requested,
                       enum orl_bsdf_fit_symmetry *ret_symmetry, struct orl_error *err);

#endif
