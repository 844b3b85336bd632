/*
 * A virtual goniophotometer: the BSDF of a panel made of geometry and materials, as XML.
 *
 * The panel lies in the xy plane, y up, z towards the inside, as Radiance's genBSDF has it, and
 * goes on in x and y without end: a cell of it, by default the box around all surfaces, stands for
 * the whole, and what leaves the cell by one side comes in by the other. Of surfaces that reach out
 * of a given cell the parts outside are not there.
 *
 * Light is sent onto the cell from every incident direction that the basis tells apart, evenly over
 * the directions of each and over the cell, is scattered by the materials (scene/material) until it
 * leaves, and is counted where it goes. So a value is the mean of the panel's BSDF over a pair of
 * cells of the basis, with no bias; its standard error comes from independent batches.
 *
 * What is no panel is refused: suns and skies, and surfaces that shine. Nothing is written but the
 * text that is returned. The same request gives the same bytes for any number of threads.
 */
#ifndef ORIEL_BSDF_MAKE_H
#define ORIEL_BSDF_MAKE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/crew.h>
#include <oriel/error.h>
#include <oriel/files.h>

enum orl_bsdf_basis {
    ORL_BSDF_KLEMS_FULL,    /* 145 directions a hemisphere */
    ORL_BSDF_KLEMS_HALF,    /* 77 */
    ORL_BSDF_KLEMS_QUARTER, /* 41 */
    ORL_BSDF_TENSOR_TREE_3, /* which no turn about the axis changes: the mean over all turns */
    ORL_BSDF_TENSOR_TREE_4,
    ORL_BSDF_BASES,
};

/* "klems_full" and so on; NULL for what is none. */
const char *orl_bsdf_basis_name(enum orl_bsdf_basis basis);
static inline bool orl_bsdf_basis_is_tree(enum orl_bsdf_basis basis)
{
    return basis == ORL_BSDF_TENSOR_TREE_3 || basis == ORL_BSDF_TENSOR_TREE_4;
}

/* Mirrors that the panel has and whose two sides are to come out the same: of matrices in their
 * mean; of trees of rank 4 one of them is measured. Not for trees of rank 3. Auto: of trees of rank
 * 4 those in the cell's middle that its surfaces are seen to have, if all of their materials are
 * even and scatter by the normal alone (goniometer/mirrors.h); else none. */
enum orl_bsdf_symmetry {
    ORL_BSDF_ASYMMETRIC = 0,
    ORL_BSDF_LEFT_RIGHT = 1, /* x */
    ORL_BSDF_UP_DOWN = 2,    /* y */
    ORL_BSDF_QUADRILATERAL = 3,
    ORL_BSDF_SYMMETRY_AUTO = 4,
};

enum {
    ORL_BSDF_MAKE_BATCHES = 16,
    ORL_BSDF_MAKE_PATHS_LEAST = ORL_BSDF_MAKE_BATCHES,
    ORL_BSDF_MAKE_PATHS_MOST = 1 << 24
};

/* What a cell of a tree may send elsewhere unseen, of the light that comes. All 4096 of 64 by 64
 * that are as wrong as can be are 0.8 % of it. */
#define ORL_BSDF_UNSEEN 2e-6

struct orl_bsdf_make_request {
    char **files; /* scene texts, in order; owned */
    size_t n_files;
    char *name; /* of the material; NULL: the first file's. Owned */
    enum orl_bsdf_basis basis;
    enum orl_bsdf_symmetry symmetry;
    bool color;          /* X and Z beside Y, of trees u' and v'; errors are of Y */
    bool has_cell;       /* or the box around the panel */
    double cell[4];      /* x from, x to, y from, y to: the files' coordinates */
    uint32_t resolution; /* of trees: cells a side of the square, a power of two from 4 to 128 */
    double cull; /* of trees: cells are one where they are within this share of their mean, 0..1, or
                    within what their errors explain (goniometer/forest.h), colours too (hues.h), */
    double unseen;  /* or where they send no more than this share of the light elsewhere */
    uint32_t paths; /* an incident direction; with an accuracy those to begin with; 0: by the basis
                       (orl_bsdf_make_paths) */
    /*
     * Paths are doubled, for incident directions that need it, until the standard error of every
     * value of at least a hundredth of the largest of its part is at most this share of it; 0: not
     * asked for. Beyond paths_most for one direction it is given up: orl_bsdf_made.reached. Of
     * trees a value that stands for several finest cells counts with the error of a quarter of it:
     * of what the next subdivision would show (goniometer/resolve.h). Half of the paths decide
     * whether all of them are enough, and the other half, independent of these, tells the errors
     * that are stated (goniometer/sheet.h): of thousands some are by chance larger than asked for,
     * up to twice. It is a standard error by the paths that were drawn, and bounds no value: of
     * tens of thousands the worst is off by four of them (of the office's panel 64 by 64 to 0.02 by
     * 7.7 %, to 0.005 by 1.5 %), and what no path has met yet none of them knows.
     */
    double accuracy;
    uint32_t paths_most;
    uint64_t seed;
    bool tell_errors; /* orl_bsdf_made.errors_xml is wanted */
};

/* Klems full, seed 1, symmetry auto; of trees a resolution of 64, a cull of 0.05. */
void orl_bsdf_make_request_init(struct orl_bsdf_make_request *request);
void orl_bsdf_make_request_done(struct orl_bsdf_make_request *request);

/* Those of the request, or of its basis: 16384; of trees of rank 3 and 4 32768 and 4096, with an
 * accuracy 2048. */
uint32_t orl_bsdf_make_paths(const struct orl_bsdf_make_request *request);

/* Seconds of one core that it takes, roughly: nothing of the panel is known. With an accuracy those
 * to begin with. */
double orl_bsdf_make_core_s(const struct orl_bsdf_make_request *request);

/* What can be told of a request without its files: 0, ORL_ERR_INVALID, ORL_ERR_RANGE. */
int orl_bsdf_make_validate(const struct orl_bsdf_make_request *request, struct orl_error *err);

/* Work in lots, none of which needs another: what comes of one goes by bytes. */
struct orl_bsdf_lots {
    const char *name; /* no others of the BSDF have it */
    size_t n;
    void *ctx;
    double (*core_s)(void *ctx, size_t lot); /* that one core is thought to take for it */
    /* Makes one, which is then the caller's own, too: *ret_data by malloc, for others, its size a
     * multiple of 4. */
    int (*make)(void *ctx, size_t lot, void **ret_data, size_t *ret_size, struct orl_error *err);
    /* Takes what others have made of one. *ret_taken: it is what it should be. */
    int (*take)(void *ctx, size_t lot, const void *data, size_t size, bool *ret_taken,
                struct orl_error *err);
    void (*told)(void *ctx, double share); /* how much of them is made elsewhere */
};

/* Has all lots made or taken (oriel/bsdf_shared.h). */
struct orl_bsdf_sharing {
    void *ctx;
    int (*run)(void *ctx, const struct orl_bsdf_lots *lots, struct orl_error *err);
};

struct orl_bsdf_make_env {
    const struct orl_files *files; /* borrowed */
    struct orl_crew *crew;         /* borrowed; led by the caller */
    const atomic_bool *cancel;     /* borrowed; may be NULL */
    /* Called by the lead, now and then: the share that is done, which never falls; with an accuracy
     * it is of the round. May be NULL. */
    void (*progress)(void *ctx, uint32_t round, double fraction);
    void *ctx;
    /* Borrowed: who makes paths of incident directions with it: the same BSDF. NULL: nobody. Not
     * of what is fitted or converted. */
    const struct orl_bsdf_sharing *shared;
};

/* A share of light with its standard error. */
struct orl_bsdf_share {
    double value, error;
};

/* Index 1 is light from the front (inside), 0 from the back; then reflected, transmitted. */
struct orl_bsdf_made_direction {
    double theta_deg, phi_deg; /* the middle of the cell; where the light comes from */
    struct orl_bsdf_share shares[2][2];
};

struct orl_bsdf_made {
    char *xml; /* owned, ends in 0 */
    size_t xml_size;
    /* The same file with standard errors in the place of values, 1/sr, to look at and to plot; NULL
     * unless it was wanted. Of cells of a tree that are one the error holds what they are off by
     * from their mean, as rms. Owned. */
    char *errors_xml;
    size_t errors_xml_size;
    size_t n_directions;                        /* of a matrix; 0 of trees */
    struct orl_bsdf_made_direction *directions; /* owned */
    struct orl_bsdf_share diffuse[2][2];        /* of perfectly diffuse light */
    float *errors[2][2]; /* standard errors, 1/sr, with room for one path more or less: [direction
                            in][direction out]; owned; NULL of trees */
    double worst;        /* largest share of the error in a value, as accuracy has it */
    double joined;       /* of trees: the largest share of a value that the finest cells it stands
                            for are off by, as rms and as far as errors do not explain it */
    bool reached; /* the accuracy, as far as it is decided by; true when none was asked for */
    uint64_t paths;
    double lost;              /* share of the light that was given up inside the panel */
    double cell[4], depth[2]; /* the files' coordinates; depth: z from, to */
};

/*
 * Returns 0 and what the caller frees by orl_bsdf_made_done; or what reading the scene says, or
 * ORL_ERR_INVALID (no panel), ORL_ERR_NOMEM, ORL_ERR_CANCELLED.
 */
int orl_bsdf_make(const struct orl_bsdf_make_request *request, const struct orl_bsdf_make_env *env,
                  struct orl_bsdf_made *ret_made, struct orl_error *err);
void orl_bsdf_made_done(struct orl_bsdf_made *made);

#endif
