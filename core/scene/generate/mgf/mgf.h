/*
 * Geometry in the Materials and Geometry Format (MGF), as in BSDF files: read, and written as the
 * scene text of Radiance's mgf2rad, with the same numbers and kinds of material.
 *
 * Supported: colours (c cxy cspec cct cmix); materials (m rd td rs ts ed ir sides); vertices (v p
 * n); faces (f fh), prisms, spheres, cylinders, cones, rings, tori; names (o); transforms (xf, also
 * arrays); included files (i), if orl_mgf.open is set. Spectra become RGB
 * (material/patterns/observer.h). Corner normals are ignored with a warning: faces are flat.
 * Luminaires (ies) are refused; unknown entities are ignored with a warning, as the format
 * requires.
 *
 * Reference: "The Materials and Geometry Format", version 2.0, distributed with Radiance.
 */
#ifndef ORL_SCENE_GENERATE_MGF_MGF_H
#define ORL_SCENE_GENERATE_MGF_MGF_H

#include "scene/generate/generate.h"

/* A file or a part of one. */
struct orl_mgf_text {
    const char *file;   /* for messages */
    const char *folder; /* where names in it are searched first */
    int line;           /* number of its first line in the file */
    const char *data;   /* need not end in NUL */
    size_t size;
};

struct orl_mgf {
    struct orl_mgf_text text;
    /* Opens a file that a text names, which stays open; may be NULL. */
    int (*open)(void *ctx, const char *folder, const char *name, struct orl_mgf_text *ret_text,
                struct orl_error *err);
    void *ctx;
    double unit_m;      /* length of its unit in the scene's units: everything is scaled by it */
    double glow_radius; /* lamps become glows with this radius; 0: they become lights */
    double emission;    /* factor of all lamps' emission */
};

/* Adds to text. Returns 0, or ORL_ERR_SYNTAX, _RANGE, _UNSUPPORTED, _LIMIT (too much content),
 * _NOMEM, with file and line. */
int orl_mgf_write(const struct orl_mgf *mgf, struct orl_text *text, struct orl_error *err);

#endif
