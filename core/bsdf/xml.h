/*
 * Inside the reader of BSDF files: the state that expat's callbacks (xml.c) and the readers of the
 * single elements (xml_fields.c) share. Not for anyone else.
 *
 * The first error wins: it is noted with its place, the parser is stopped, and whatever callback
 * may still come does nothing.
 */
#ifndef ORL_BSDF_XML_H
#define ORL_BSDF_XML_H

#include <expat.h>
#include <oriel/limits.h>

#include "bsdf/blocks.h"
#include "bsdf/document.h"
#include "bsdf/text.h"

/* The elements that mean something here, by their place in the document. */
enum orl_xml_element {
    EL_OTHER, /* and everything below it */
    EL_DOCUMENT,
    EL_WINDOW,
    EL_FILE_TYPE,
    EL_OPTICAL,
    EL_LAYER,
    EL_MATERIAL,
    EL_NAME,
    EL_THICKNESS,
    EL_DEFINITION,
    EL_STRUCTURE,
    EL_BASIS,
    EL_BASIS_NAME,
    EL_RING,
    EL_RING_CELLS,
    EL_RING_BOUNDS,
    EL_RING_LOWER,
    EL_RING_UPPER,
    EL_WAVELENGTH_DATA,
    EL_WAVELENGTH,
    EL_BLOCK,
    EL_DIRECTION,
    EL_COLUMN_BASIS,
    EL_ROW_BASIS,
    EL_TREE_BASIS,
    EL_DATA,
};

enum { ORL_XML_BASES_MAX = 8, ORL_XML_TEXT_MAX = 256 };

struct orl_xml_reader {
    XML_Parser parser;
    struct orl_document *document;
    struct orl_error *err;
    const char *file;
    int code; /* the first error, after which nothing is done */
    enum orl_xml_element path[ORL_LIMIT_XML_DEPTH];
    unsigned depth;
    unsigned layers;
    const char *fed_to;  /* end of the piece that expat is at */
    bool plain;          /* that piece ends amid the data, in plain text that has been read */
    size_t passed_lines; /* that expat does not get to see: see read_plain in xml.c; nor are those
                            of blocks */
    char text[ORL_XML_TEXT_MAX]; /* of the element at hand, when it is a short one */
    size_t text_length;
    double thickness_unit;
    struct orl_basis bases[ORL_XML_BASES_MAX]; /* the file's own */
    unsigned n_bases;
    double ring_cells, ring_lower, ring_upper;
    /* The WavelengthData and its block at hand. */
    int channel; /* -1: none that is read; 0: Visible; 1, 2: the first and second of colour */
    int part;    /* an enum orl_bsdf_part, or -1 */
    bool tree_basis;
    struct orl_basis basis[2];
    bool have_basis[2];
    bool reading;     /* inside ScatteringData that is wanted */
    bool putting_off; /* what is left of it: the last of the blocks */
    struct orl_blocks blocks;
    struct orl_tree_text tree_text;
    struct orl_matrix_text matrix_text;
};

/* Notes an error, its message already in reader->err, with its place; stops the parser. */
void orl_xml_fail(struct orl_xml_reader *reader, int code);

/* The element of that name within another, EL_DOCUMENT for the root; or EL_OTHER (xml_names.c). */
enum orl_xml_element orl_xml_element_in(enum orl_xml_element parent, const char *name);
/* The name of an element that means something, or "". */
const char *orl_xml_element_name(enum orl_xml_element element);

/* What an element's attribute "unit" stands for, m; metres where it has none that is known
 * (xml_fields.c). */
double orl_xml_unit_m(const char **attributes);

/* ---- Readers of elements (xml_fields.c) ------------------------------------------------------ */

/* An element begins; attributes as expat gives them. */
void orl_xml_begin(struct orl_xml_reader *reader, enum orl_xml_element element,
                   const char **attributes);
/* A piece of ScatteringData that is wanted. Returns 0, or an error with the place it was found at.
 */
int orl_xml_feed(struct orl_xml_reader *reader, const char *text, size_t length,
                 const char **ret_place);
/* Puts off what stands there of the data at hand, plain text, where that may be. */
bool orl_xml_may_put_off(const struct orl_xml_reader *reader);
void orl_xml_put_off(struct orl_xml_reader *reader, size_t begin, size_t end);
/* There is more of data put off, and it is no plain text: reads them now. Returns 0, or the code
 * of an error that has been noted. */
int orl_xml_catch_up(struct orl_xml_reader *reader);
/* An element ends; reader->text holds its text, trimmed, when it is a short one. */
void orl_xml_end(struct orl_xml_reader *reader, enum orl_xml_element element);

#endif
