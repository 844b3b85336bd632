/*
 * Geometry in the Materials and Geometry Format (MGF), as BSDF files carry it: read, and written as
 * the scene text that Radiance's mgf2rad makes of it, with the same numbers and kinds of material.
 *
 * Read are colours (c cxy cspec cct cmix), materials (m rd td rs ts ed ir sides), vertices (v p n),
 * faces (f fh), prisms, spheres, cylinders, cones, rings, tori, names (o), transforms (xf, arrays
 * of them too) and other files (i), where there is a way to open them. Spectra become RGB
 * (material/observer.h). Normals of corners are left out, with a warning: faces are flat.
 * Luminaires (ies) are refused; entities that the format does not have are passed over, with a
 * warning, as it asks for.
 *
 * Reference: "The Materials and Geometry Format", version 2.0, which Radiance carries.
 */
#ifndef ORL_SCENE_GENERATE_MGF_H
#define ORL_SCENE_GENERATE_MGF_H

#include "scene/generate/generate.h"

/* A file, or a part of one. */
struct orl_mgf_text {
    const char *file;   /* for messages */
    const char *folder; /* where names in it are looked for first */
    int line;           /* of its first line there */
    const char *data;   /* need not end in NUL */
    size_t size;
};

struct orl_mgf {
    struct orl_mgf_text text;
    /* Opens a file that a text names, which stays open; or NULL. */
    int (*open)(void *ctx, const char *folder, const char *name, struct orl_mgf_text *ret_text,
                struct orl_error *err);
    void *ctx;
    double unit_m;      /* its unit of length in the scene's: all is scaled by it */
    double glow_radius; /* lamps are glows of that reach; 0: they are lights */
    double emission;    /* factor on all lamps */
};

/* Adds to text. ORL_ERR_SYNTAX, _RANGE, _UNSUPPORTED, _LIMIT (too much of it), _NOMEM, with file
 * and line. */
int orl_mgf_write(const struct orl_mgf *mgf, struct orl_text *text, struct orl_error *err);

#endif
