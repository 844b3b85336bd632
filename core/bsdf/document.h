/*
 * What a BSDF file says, before sides are turned and gaps are filled: the reader (xml.c) makes it,
 * the front (bsdf.c) takes it over.
 */
#ifndef ORL_BSDF_DOCUMENT_H
#define ORL_BSDF_DOCUMENT_H

#include "bsdf/iso.h"
#include "bsdf/matrix.h"
#include "bsdf/tree.h"

/* The file's own names for the four components; Front is the exterior. */
enum orl_part {
    ORL_PART_TRANSMISSION_FRONT,
    ORL_PART_TRANSMISSION_BACK,
    ORL_PART_REFLECTION_FRONT,
    ORL_PART_REFLECTION_BACK,
    ORL_PART_COUNT
};

enum orl_structure {
    ORL_STRUCTURE_NONE,
    ORL_STRUCTURE_TREE3,
    ORL_STRUCTURE_TREE4,
    ORL_STRUCTURE_MATRIX
};

struct orl_component {
    bool present;
    struct orl_tree tree;     /* for TREE4 */
    struct orl_iso iso;       /* for TREE3 */
    struct orl_matrix matrix; /* for MATRIX */
};

struct orl_document {
    char name[128];     /* of the material, "" when not given */
    double thickness_m; /* 0 when not given */
    enum orl_structure structure;
    bool colored; /* there are CIE channels beside Visible, which are not read */
    bool by_rows; /* MATRIX: Rows rather than Columns */
    struct orl_component parts[ORL_PART_COUNT];
};

/* Reads the XML into *ret_document, to be passed to orl_document_done. */
int orl_document_read(const char *name, const char *xml, size_t size,
                      struct orl_document *ret_document, struct orl_error *err);
void orl_document_done(struct orl_document *document);

#endif
