/*
 * Contents of a BSDF file, before sides are turned and gaps are filled. The reader (xml.c) builds
 * it; orl_bsdf_load (bsdf.c) takes ownership.
 */
#ifndef ORL_BSDF_DOCUMENT_H
#define ORL_BSDF_DOCUMENT_H

#include <oriel/bsdf/bsdf.h>

#include "bsdf/chroma.h"
#include "bsdf/data.h"
#include "bsdf/matrix/matrix.h"
#include "bsdf/peak.h"
#include "bsdf/tree/tree.h"

/* The file's own names for the four components; Front is the exterior. */
enum orl_component_kind {
    ORL_COMPONENT_TRANSMISSION_FRONT,
    ORL_COMPONENT_TRANSMISSION_BACK,
    ORL_COMPONENT_REFLECTION_FRONT,
    ORL_COMPONENT_REFLECTION_BACK,
    ORL_COMPONENT_COUNT
};

extern const char *const orl_component_names[ORL_COMPONENT_COUNT];

struct orl_component {
    bool present;
    struct orl_tree tree;     /* for TREE4 */
    struct orl_iso iso;       /* for TREE3 */
    struct orl_matrix matrix; /* for MATRIX */
    struct orl_chroma chroma;
    struct orl_peak peak; /* for transmissions only */
};

/* Values, integrals and samples of luminance, like the functions of the same names in tree.h. */
double orl_component_eval(enum orl_structure structure, const struct orl_component *component,
                          const struct orl_coords *a, const struct orl_coords *b);
double orl_component_total(enum orl_structure structure, const struct orl_component *component,
                           enum orl_tree_axis given, const struct orl_coords *coords);
double orl_component_sample(enum orl_structure structure, const struct orl_component *component,
                            enum orl_tree_axis given, const struct orl_coords *coords,
                            const double u[2], struct orl_vec3 *ret_other);

/* bytes: memory used; values: number of values read; resolution: as in orl_bsdf_info; clamped:
 * number of clamped values. */
size_t orl_component_bytes(enum orl_structure structure, const struct orl_component *component);
size_t orl_component_values(enum orl_structure structure, const struct orl_component *component);
int orl_component_resolution(enum orl_structure structure, const struct orl_component *component);
size_t orl_component_clamped(enum orl_structure structure, const struct orl_component *component);
void orl_component_done(struct orl_component *component); /* a partly built component is allowed */

struct orl_document {
    char name[128];       /* the material's name; "" if not given */
    double thickness_m;   /* 0 when not given */
    size_t skipped_bytes; /* bytes of text before the XML */
    enum orl_structure structure;
    bool by_rows; /* MATRIX: true for Rows, false for Columns */
    struct orl_component parts[ORL_COMPONENT_COUNT];
};

/* Reads the XML into *ret_document; free it with orl_document_done. */
int orl_document_read(const struct orl_bsdf_xml *xml, struct orl_document *ret_document,
                      struct orl_error *err);
void orl_document_done(struct orl_document *document);

#endif
