/*
 * State shared by expat's callbacks (xml.c) and the readers of single elements (xml_fields.c), and
 * the blocks of data that are read after parsing. For the reader of BSDF files only.
 */
#ifndef ORL_BSDF_XML_XML_H
#define ORL_BSDF_XML_XML_H

#include <expat.h>

#include <oriel/base/limits.h>
#include <oriel/bsdf/bsdf.h>

#include "bsdf/document.h"
#include "bsdf/xml/data_text.h"

/*
 * Blocks of tensor-tree data that are skipped while the XML is parsed and then read in parallel by
 * a thread pool. Most of a file is such data. It is plain text up to the block's end tag, so its
 * position is enough to find it again.
 */

enum { ORL_BLOCKS_MAX = 3 * ORL_COMPONENT_COUNT }; /* a part has at most three channels */

struct orl_block {
    struct orl_tree_text text; /* parser state after the text that was read before */
    size_t begin, end;         /* range of the deferred text, bytes of the XML */
    size_t line;               /* line number at begin, without the lines inside earlier blocks */
    int part;                  /* an enum orl_component_kind, for messages */
    bool ended;                /* true if the block's end tag was seen: the tree must be complete */
    int code;
    struct orl_error err;
};

struct orl_blocks {
    const struct orl_bsdf_xml *xml; /* borrowed */
    size_t count;
    struct orl_block blocks[ORL_BLOCKS_MAX]; /* in the file's order */
};

/*
 * orl_block_read reads one block; orl_blocks_read reads all with the thread pool of the XML. Both
 * return 0 or a negative enum orl_err, that of the first block that failed, with line and element
 * set.
 */
int orl_block_read(struct orl_blocks *blocks, size_t index, struct orl_error *err);
int orl_blocks_read(struct orl_blocks *blocks, struct orl_error *err);
void orl_blocks_done(struct orl_blocks *blocks);

/* Returns the number of newlines in the first `count` blocks. */
size_t orl_blocks_lines(const struct orl_blocks *blocks, size_t count);

/* Returns the number of newlines from text up to end. */
size_t orl_count_lines(const char *text, const char *end);

/* Writes the name of a block for messages: its element and direction. */
void orl_block_name(int part, char *ret_name, size_t size);

/* Elements that are read, by their place in the document. */
enum orl_xml_element {
    EL_OTHER, /* also everything below it */
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

/*
 * State of the reader. The first error is recorded with its place; the parser is stopped and later
 * callbacks do nothing.
 */
struct orl_xml_reader {
    XML_Parser parser;
    struct orl_document *document;
    struct orl_error *err;
    const char *file;
    int code; /* the first error; nothing is done after it */
    enum orl_xml_element path[ORL_LIMIT_XML_DEPTH];
    unsigned depth;
    unsigned layers;
    const char *fed_to;  /* end of the piece that expat is processing */
    bool plain;          /* true if that piece ends inside data, in plain text that has been read */
    size_t passed_lines; /* lines that expat does not see (xml.c), except those of blocks */
    char text[ORL_XML_TEXT_MAX]; /* text of the current element, if short */
    size_t text_length;
    double thickness_unit;
    struct orl_basis bases[ORL_XML_BASES_MAX]; /* bases defined in the file */
    unsigned n_bases;
    double ring_cells, ring_lower, ring_upper;
    /* The current WavelengthData and its block. */
    int channel; /* -1: a channel that is not read; 0: Visible; 1, 2: first and second of colour */
    int part;    /* an enum orl_component_kind, or -1 */
    bool tree_basis;
    struct orl_basis basis[2];
    bool have_basis[2];
    bool reading;   /* true inside ScatteringData that are read */
    bool deferring; /* true if the rest of the data is in the last block, to be read later */
    struct orl_blocks blocks;
    struct orl_tree_text tree_text;
    struct orl_matrix_text matrix_text;
};

/* Records an error with its place and stops the parser. The message must be in reader->err. */
void orl_xml_fail(struct orl_xml_reader *reader, int code);
/* Sets the message as printf does, then records the error. */
#define FAIL(r, code, ...) orl_xml_fail(r, orl_error_set((r)->err, code, __VA_ARGS__))

/* Returns the element of that name within the parent (EL_DOCUMENT for the root), or EL_OTHER. */
enum orl_xml_element orl_xml_element_in(enum orl_xml_element parent, const char *name);
/* Returns the name of an element that is read, or "". */
const char *orl_xml_element_name(enum orl_xml_element element);

/* Returns the unit in an element's attribute "unit", m; 1 if missing or unknown (xml_fields.c). */
double orl_xml_unit_m(const char **attributes);

/* ---- Readers of elements (xml_fields.c) ------------------------------------------------------ */

/* Begins an element; attributes as expat gives them. */
void orl_xml_begin(struct orl_xml_reader *reader, enum orl_xml_element element,
                   const char **attributes);
/* Parses a piece of ScatteringData. Returns 0, or an error with its place in the text. */
int orl_xml_feed(struct orl_xml_reader *reader, const char *text, size_t length,
                 const char **ret_place);
/* orl_xml_may_defer: true if the plain text that follows may be deferred. orl_xml_defer: defers
 * the text from begin to end to a block. */
bool orl_xml_may_defer(const struct orl_xml_reader *reader);
void orl_xml_defer(struct orl_xml_reader *reader, size_t begin, size_t end);
/* Reads the last block now, because its data continue with text that is not plain. Returns 0, or
 * the code of an error that has been recorded. */
int orl_xml_read_deferred(struct orl_xml_reader *reader);
/* Ends an element; reader->text holds its trimmed text if it is short. */
void orl_xml_end(struct orl_xml_reader *reader, enum orl_xml_element element);

#endif
