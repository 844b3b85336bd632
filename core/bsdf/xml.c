/*
 * Streams a BSDF file through expat. Elements are recognised by their place in the document (a
 * table of parent and name), so that what is not known is passed over with all it holds. A DTD,
 * and with it any entity of the file's own, is refused before it is read.
 */
#include "bsdf/document.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <expat.h>
#include <oriel/limits.h>

#include "bsdf/text.h"

enum element {
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

static const struct {
    enum element parent;
    const char *name;
    enum element element;
} elements[] = {
    {EL_DOCUMENT, "WindowElement", EL_WINDOW},
    {EL_WINDOW, "FileType", EL_FILE_TYPE},
    {EL_WINDOW, "Optical", EL_OPTICAL},
    {EL_OPTICAL, "Layer", EL_LAYER},
    {EL_LAYER, "Material", EL_MATERIAL},
    {EL_MATERIAL, "Name", EL_NAME},
    {EL_MATERIAL, "Thickness", EL_THICKNESS},
    {EL_LAYER, "DataDefinition", EL_DEFINITION},
    {EL_DEFINITION, "IncidentDataStructure", EL_STRUCTURE},
    {EL_DEFINITION, "AngleBasis", EL_BASIS},
    {EL_BASIS, "AngleBasisName", EL_BASIS_NAME},
    {EL_BASIS, "AngleBasisBlock", EL_RING},
    {EL_RING, "nPhis", EL_RING_CELLS},
    {EL_RING, "ThetaBounds", EL_RING_BOUNDS},
    {EL_RING_BOUNDS, "LowerTheta", EL_RING_LOWER},
    {EL_RING_BOUNDS, "UpperTheta", EL_RING_UPPER},
    {EL_LAYER, "WavelengthData", EL_WAVELENGTH_DATA},
    {EL_WAVELENGTH_DATA, "Wavelength", EL_WAVELENGTH},
    {EL_WAVELENGTH_DATA, "WavelengthDataBlock", EL_BLOCK},
    {EL_BLOCK, "WavelengthDataDirection", EL_DIRECTION},
    {EL_BLOCK, "ColumnAngleBasis", EL_COLUMN_BASIS},
    {EL_BLOCK, "RowAngleBasis", EL_ROW_BASIS},
    {EL_BLOCK, "AngleBasis", EL_TREE_BASIS},
    {EL_BLOCK, "ScatteringData", EL_DATA},
};

enum { BASES_MAX = 8, TEXT_MAX = 256, SLICE_BYTES = 1 << 20 };

struct reader {
    XML_Parser parser;
    struct orl_document *document;
    struct orl_error *err;
    const char *file;
    int code; /* the first error, after which nothing is done */
    enum element path[ORL_LIMIT_XML_DEPTH];
    unsigned depth;
    unsigned layers;
    char text[TEXT_MAX]; /* of the element at hand, when it is a short one */
    size_t text_length;
    double thickness_unit;
    struct orl_basis bases[BASES_MAX]; /* the file's own */
    unsigned n_bases;
    double ring_cells, ring_lower, ring_upper;
    /* The WavelengthData and its block at hand. */
    bool visible;
    int part; /* an enum orl_part, or -1 */
    bool tree_basis;
    struct orl_basis basis[2];
    bool have_basis[2];
    bool reading; /* inside ScatteringData that is wanted */
    struct orl_tree_text tree_text;
    struct orl_matrix_text matrix_text;
};

static const char *const part_names[ORL_PART_COUNT] = {"Transmission Front", "Transmission Back",
                                                       "Reflection Front", "Reflection Back"};

/* Where the reader is, for a message: the block with its direction, or the element. */
static void name_place(const struct reader *r, char *ret_name, size_t size)
{
    const enum element here = r->depth > 0 ? r->path[r->depth - 1] : EL_DOCUMENT;
    if (here >= EL_BLOCK && r->part >= 0) {
        snprintf(ret_name, size, "WavelengthDataBlock %s", part_names[r->part]);
        return;
    }
    snprintf(ret_name, size, "%s", "");
    for (size_t i = 0; i < sizeof elements / sizeof *elements; i++)
        if (elements[i].element == here)
            snprintf(ret_name, size, "%s", elements[i].name);
}

/* Notes an error (already in r->err when it came from below) with its place, and stops. */
static void fail(struct reader *r, int code)
{
    char place[ORL_ERROR_NAME_MAX];
    if (r->code < 0)
        return;
    r->code = code;
    name_place(r, place, sizeof place);
    orl_error_at(r->err, r->file, (int)XML_GetCurrentLineNumber(r->parser), place);
    XML_StopParser(r->parser, XML_FALSE);
}

#define FAIL(r, code, ...) fail(r, orl_error_set((r)->err, code, __VA_ARGS__))

/* ---- Short elements ----------------------------------------------------------------------------
 */

static void read_structure(struct reader *r)
{
    struct orl_document *d = r->document;
    if (d->structure != ORL_STRUCTURE_NONE)
        FAIL(r, ORL_ERR_SYNTAX, "IncidentDataStructure is given twice");
    else if (!strcasecmp(r->text, "TensorTree4"))
        d->structure = ORL_STRUCTURE_TREE4;
    else if (!strcasecmp(r->text, "Columns") || !strcasecmp(r->text, "Rows"))
        d->structure = ORL_STRUCTURE_MATRIX;
    else
        FAIL(r, ORL_ERR_UNSUPPORTED,
             "IncidentDataStructure '%s' is not supported (TensorTree4, Columns and Rows are)",
             r->text);
    d->by_rows = !strcasecmp(r->text, "Rows");
}

static void read_thickness(struct reader *r)
{
    double value = 0;
    if (r->text[0] == '\0')
        return;
    if (orl_number_parse(r->text, r->text_length, &value, r->err) < 0 || value < 0) {
        FAIL(r, ORL_ERR_RANGE, "thickness '%s' is not a number of at least 0", r->text);
        return;
    }
    r->document->thickness_m = value * r->thickness_unit;
}

static void read_number(struct reader *r, double *ret_value)
{
    const int code = orl_number_parse(r->text, r->text_length, ret_value, r->err);
    if (code < 0)
        fail(r, code);
}

static void read_part(struct reader *r)
{
    for (int i = 0; i < ORL_PART_COUNT; i++)
        if (!strcasecmp(r->text, part_names[i]))
            r->part = i;
    if (r->part < 0)
        FAIL(r, ORL_ERR_SYNTAX, "unknown WavelengthDataDirection '%s'", r->text);
    else if (r->visible && r->document->parts[r->part].present)
        FAIL(r, ORL_ERR_SYNTAX, "%s is given twice for Visible", part_names[r->part]);
}

static void read_basis_name(struct reader *r, enum orl_axis axis)
{
    for (unsigned i = 0; i < r->n_bases; i++) {
        if (!strcasecmp(r->bases[i].name, r->text) && r->bases[i].n_rings > 0) {
            r->basis[axis] = r->bases[i];
            r->have_basis[axis] = true;
            return;
        }
    }
    r->have_basis[axis] = orl_basis_standard(r->text, &r->basis[axis]) == 0;
    if (!r->have_basis[axis])
        FAIL(r, ORL_ERR_UNSUPPORTED, "angle basis '%s' is neither defined here nor a standard one",
             r->text);
}

static void add_ring(struct reader *r)
{
    const int code = orl_basis_add_ring(&r->bases[r->n_bases - 1], r->ring_lower, r->ring_upper,
                                        r->ring_cells, r->err);
    if (code < 0)
        fail(r, code);
}

/* ---- Scattering data ---------------------------------------------------------------------------
 */

static void begin_data(struct reader *r)
{
    struct orl_component *component;
    int code = 0;
    r->reading = false;
    if (!r->visible)
        return;
    if (r->part < 0) {
        FAIL(r, ORL_ERR_SYNTAX, "ScatteringData before its WavelengthDataDirection");
        return;
    }
    component = &r->document->parts[r->part];
    switch (r->document->structure) {
    case ORL_STRUCTURE_TREE4:
        if (!r->tree_basis)
            code = orl_error_set(r->err, ORL_ERR_SYNTAX, "a tensor tree without its AngleBasis");
        orl_tree_text_init(&r->tree_text, &component->tree);
        break;
    case ORL_STRUCTURE_MATRIX:
        if (!r->have_basis[0] || !r->have_basis[1])
            code = orl_error_set(r->err, ORL_ERR_SYNTAX,
                                 "a matrix without its ColumnAngleBasis and RowAngleBasis");
        else
            code = orl_matrix_init(&component->matrix, &r->basis[0], &r->basis[1], r->err);
        orl_matrix_text_init(&r->matrix_text, &component->matrix, r->document->by_rows);
        break;
    default:
        code = orl_error_set(r->err, ORL_ERR_SYNTAX, "data before the IncidentDataStructure");
        break;
    }
    if (code < 0)
        fail(r, code);
    else
        r->reading = component->present = true;
}

static void feed_data(struct reader *r, const char *text, size_t length)
{
    const int code = r->document->structure == ORL_STRUCTURE_TREE4
                         ? orl_tree_text_feed(&r->tree_text, text, length, r->err)
                         : orl_matrix_text_feed(&r->matrix_text, text, length, r->err);
    if (code < 0)
        fail(r, code);
}

static void end_data(struct reader *r)
{
    const int code = r->document->structure == ORL_STRUCTURE_TREE4
                         ? orl_tree_text_finish(&r->tree_text, r->err)
                         : orl_matrix_text_finish(&r->matrix_text, r->err);
    r->reading = false;
    orl_tree_text_done(&r->tree_text);
    if (code < 0)
        fail(r, code);
}

/* ---- Expat's callbacks -------------------------------------------------------------------------
 */

static double unit_in_m(const XML_Char **attributes)
{
    static const struct {
        const char *name;
        double m;
    } units[] = {{"Meter", 1},
                 {"Millimeter", 0.001},
                 {"Centimeter", 0.01},
                 {"Inch", 0.0254},
                 {"Foot", 0.3048}};
    for (; attributes[0]; attributes += 2)
        for (size_t i = 0; !strcmp(attributes[0], "unit") && i < sizeof units / sizeof *units; i++)
            if (!strcasecmp(attributes[1], units[i].name))
                return units[i].m;
    return 1;
}

static enum element element_at(struct reader *r, const char *name)
{
    const enum element parent = r->depth > 0 ? r->path[r->depth - 1] : EL_DOCUMENT;
    for (size_t i = 0; i < sizeof elements / sizeof *elements; i++)
        if (elements[i].parent == parent && !strcmp(elements[i].name, name))
            /* Radiance reads the first layer of a file; so do we. */
            return elements[i].element == EL_LAYER && r->layers++ > 0 ? EL_OTHER
                                                                      : elements[i].element;
    return EL_OTHER;
}

static void on_start(void *ctx, const XML_Char *name, const XML_Char **attributes)
{
    struct reader *r = ctx;
    enum element element;
    if (r->code < 0)
        return;
    element = element_at(r, name);
    if (r->depth == 0 && element != EL_WINDOW) {
        FAIL(r, ORL_ERR_SYNTAX, "the file is no BSDF: its root is '%.64s', not 'WindowElement'",
             name);
        return;
    }
    if (r->depth == ORL_LIMIT_XML_DEPTH) {
        FAIL(r, ORL_ERR_LIMIT, "elements are nested deeper than %u", ORL_LIMIT_XML_DEPTH);
        return;
    }
    r->path[r->depth++] = element;
    r->text_length = 0;
    if (element == EL_THICKNESS) {
        r->thickness_unit = unit_in_m(attributes);
    } else if (element == EL_BASIS) {
        if (r->n_bases == BASES_MAX)
            FAIL(r, ORL_ERR_LIMIT, "more than %d angle bases", BASES_MAX);
        else
            orl_basis_init(&r->bases[r->n_bases++], "");
    } else if (element == EL_RING) {
        r->ring_cells = r->ring_lower = r->ring_upper = 0;
    } else if (element == EL_WAVELENGTH_DATA) {
        r->visible = false;
    } else if (element == EL_BLOCK) {
        r->part = -1;
        r->tree_basis = r->have_basis[0] = r->have_basis[1] = false;
    } else if (element == EL_DATA) {
        begin_data(r);
    }
}

static void on_text(void *ctx, const XML_Char *text, int length)
{
    struct reader *r = ctx;
    size_t room = TEXT_MAX - 1 - r->text_length, count = (size_t)length;
    if (r->code < 0)
        return;
    if (r->reading && r->path[r->depth - 1] == EL_DATA) {
        feed_data(r, text, count);
        return;
    }
    if (count > room) /* longer than any name we know: it will match none */
        count = room;
    memcpy(r->text + r->text_length, text, count);
    r->text_length += count;
}

/* Cuts white space off both ends of the text and closes it. */
static void trim_text(struct reader *r)
{
    size_t start = 0;
    while (r->text_length > 0 && strchr(" \t\r\n", r->text[r->text_length - 1]))
        r->text_length--;
    while (start < r->text_length && strchr(" \t\r\n", r->text[start]))
        start++;
    r->text_length -= start;
    memmove(r->text, r->text + start, r->text_length);
    r->text[r->text_length] = '\0';
}

static void end_element(struct reader *r, enum element element)
{
    switch (element) {
    case EL_FILE_TYPE:
        if (strcmp(r->text, "BSDF") != 0)
            FAIL(r, ORL_ERR_SYNTAX, "FileType is '%s', not 'BSDF'", r->text);
        break;
    case EL_NAME:
        snprintf(r->document->name, sizeof r->document->name, "%.*s",
                 (int)sizeof r->document->name - 1, r->text);
        break;
    case EL_THICKNESS:
        read_thickness(r);
        break;
    case EL_STRUCTURE:
        read_structure(r);
        break;
    case EL_BASIS_NAME:
        snprintf(r->bases[r->n_bases - 1].name, ORL_BASIS_NAME_MAX, "%.*s", ORL_BASIS_NAME_MAX - 1,
                 r->text);
        break;
    case EL_RING_CELLS:
        read_number(r, &r->ring_cells);
        break;
    case EL_RING_LOWER:
        read_number(r, &r->ring_lower);
        break;
    case EL_RING_UPPER:
        read_number(r, &r->ring_upper);
        break;
    case EL_RING:
        add_ring(r);
        break;
    case EL_WAVELENGTH:
        r->visible = !strcasecmp(r->text, "Visible");
        break;
    case EL_DIRECTION:
        read_part(r);
        break;
    case EL_COLUMN_BASIS:
        if (r->visible)
            read_basis_name(r, ORL_AXIS_A);
        break;
    case EL_ROW_BASIS:
        if (r->visible)
            read_basis_name(r, ORL_AXIS_B);
        break;
    case EL_TREE_BASIS:
        r->tree_basis = !strcasecmp(r->text, "LBNL/Shirley-Chiu");
        if (r->visible && !r->tree_basis)
            FAIL(r, ORL_ERR_UNSUPPORTED, "angle basis '%s' of a tensor tree", r->text);
        break;
    case EL_DATA:
        if (r->reading)
            end_data(r);
        break;
    default:
        break;
    }
}

static void on_end(void *ctx, const XML_Char *name)
{
    struct reader *r = ctx;
    (void)name;
    if (r->code < 0)
        return;
    trim_text(r);
    end_element(r, r->path[r->depth - 1]);
    r->depth--;
    r->text_length = 0;
}

static void on_doctype(void *ctx, const XML_Char *name, const XML_Char *system,
                       const XML_Char *public, int internal)
{
    struct reader *r = ctx;
    (void)name;
    (void)system;
    (void)public;
    (void)internal;
    FAIL(r, ORL_ERR_UNSUPPORTED, "a document type declaration; entities are not accepted");
}

/* ---- The whole ---------------------------------------------------------------------------------
 */

/* Hands the file to expat in slices; its own errors get their line here. */
static void parse(struct reader *r, const char *xml, size_t size)
{
    for (size_t at = 0; r->code == 0; at += SLICE_BYTES) {
        const bool last = size - at <= SLICE_BYTES;
        const int length = last ? (int)(size - at) : SLICE_BYTES;
        if (XML_Parse(r->parser, xml + at, length, last) == XML_STATUS_ERROR && r->code == 0) {
            const enum XML_Error error = XML_GetErrorCode(r->parser);
            FAIL(r, error == XML_ERROR_NO_MEMORY ? ORL_ERR_NOMEM : ORL_ERR_SYNTAX, "XML: %s",
                 XML_ErrorString(error));
            if (last)
                orl_error_hint(r->err, "the file may be cut short");
        }
        if (last)
            return;
    }
}

static int check_complete(const struct orl_document *d, const char *file, struct orl_error *err)
{
    int code = 0;
    bool any = false;
    for (int i = 0; i < ORL_PART_COUNT; i++)
        any |= d->parts[i].present;
    if (d->structure == ORL_STRUCTURE_NONE)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "no IncidentDataStructure in the file");
    else if (!any)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "no scattering data for Visible in the file");
    if (code < 0)
        orl_error_at(err, file, 0, "WindowElement");
    return code;
}

int orl_document_read(const char *name, const char *xml, size_t size,
                      struct orl_document *ret_document, struct orl_error *err)
{
    struct orl_error ignored;
    struct reader *r = calloc(1, sizeof *r);
    struct orl_document *document = calloc(1, sizeof *document);
    int code = ORL_ERR_NOMEM;
    if (r)
        r->parser = XML_ParserCreate(NULL);
    if (!r || !document || !r->parser) {
        orl_error_set(err, code, "out of memory reading the BSDF");
        orl_error_at(err, name, 0, NULL);
        goto done;
    }
    r->document = document;
    r->err = err ? err : &ignored;
    r->file = name;
    r->part = -1;
    XML_SetUserData(r->parser, r);
    XML_SetElementHandler(r->parser, on_start, on_end);
    XML_SetCharacterDataHandler(r->parser, on_text);
    XML_SetStartDoctypeDeclHandler(r->parser, on_doctype);
    parse(r, xml, size);
    code = r->code < 0 ? r->code : check_complete(document, name, err);
    if (code == 0) {
        *ret_document = *document;
        memset(document, 0, sizeof *document);
    }
done:
    if (r) {
        orl_tree_text_done(&r->tree_text);
        if (r->parser)
            XML_ParserFree(r->parser);
    }
    free(r);
    orl_document_done(document);
    free(document);
    return code;
}

void orl_document_done(struct orl_document *document)
{
    if (!document)
        return;
    for (int i = 0; i < ORL_PART_COUNT; i++) {
        orl_tree_done(&document->parts[i].tree);
        orl_matrix_done(&document->parts[i].matrix);
    }
    memset(document, 0, sizeof *document);
}
