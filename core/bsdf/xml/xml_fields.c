/* Elements of a BSDF file: names and parents, blocks read in parallel, and readers of elements. */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include <oriel/base/thread_pool.h>

#include "bsdf/xml/xml.h"

/* ---- Names of the elements that are read, and their parents ---------------------------------- */

static const struct {
    enum orl_xml_element parent;
    const char *name;
    enum orl_xml_element element;
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

enum orl_xml_element orl_xml_element_in(enum orl_xml_element parent, const char *name)
{
    for (size_t i = 0; i < sizeof elements / sizeof *elements; i++)
        if (elements[i].parent == parent && strcmp(elements[i].name, name) == 0)
            return elements[i].element;
    return EL_OTHER;
}

const char *orl_xml_element_name(enum orl_xml_element element)
{
    for (size_t i = 0; i < sizeof elements / sizeof *elements; i++)
        if (elements[i].element == element)
            return elements[i].name;
    return "";
}

/* ---- Blocks read in parallel ----------------------------------------------------------------- */

enum { SLICE = 1 << 20 }; /* bytes read between two checks of the cancel flag */

size_t orl_count_lines(const char *text, const char *end)
{
    size_t lines = 0;
    for (; text < end; text++)
        lines += *text == '\n';
    return lines;
}

size_t orl_blocks_lines(const struct orl_blocks *blocks, size_t count)
{
    const char *const data = blocks->xml->data;
    size_t lines = 0;
    for (size_t i = 0; i < count; i++)
        lines += orl_count_lines(data + blocks->blocks[i].begin, data + blocks->blocks[i].end);
    return lines;
}

void orl_block_name(int part, char *ret_name, size_t size)
{
    snprintf(ret_name, size, "WavelengthDataBlock %s", orl_component_names[part]);
}

/* Parses a block's text in slices, and reports each slice to the XML's `passed` callback. */
static int feed_block(const struct orl_bsdf_xml *xml, struct orl_block *block,
                      struct orl_error *err)
{
    int code = 0;
    for (size_t at = block->begin; at < block->end && code == 0;) {
        const size_t size = block->end - at < SLICE ? block->end - at : SLICE;
        if (orl_is_cancelled(xml->cancel))
            return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while reading the BSDF");
        code = orl_tree_text_feed(&block->text, xml->data + at, size, err);
        if (xml->passed)
            xml->passed(xml->ctx, at, at + size);
        at += size;
    }
    return code;
}

int orl_block_read(struct orl_blocks *blocks, size_t index, struct orl_error *err)
{
    const struct orl_bsdf_xml *xml = blocks->xml;
    struct orl_block *block = &blocks->blocks[index];
    const char *failed_at = xml->data + block->end;
    int code = feed_block(xml, block, err);
    if (code == ORL_ERR_CANCELLED)
        return code; /* not an error of the file; perhaps no text of the block was read */
    if (code < 0)
        failed_at = block->text.scan.next;
    else if (block->ended)
        code = orl_tree_text_finish(&block->text, err);
    if (code < 0) {
        const size_t line = block->line + orl_blocks_lines(blocks, index) +
                            orl_count_lines(xml->data + block->begin, failed_at);
        char place[ORL_ERROR_NAME_MAX];
        orl_block_name(block->part, place, sizeof place);
        orl_error_at(err, xml->name, (int)line, place);
    }
    return code;
}

static void read_one(void *arg, size_t index, uint32_t member)
{
    struct orl_blocks *blocks = arg;
    struct orl_block *block = &blocks->blocks[index];
    (void)member;
    block->code = orl_block_read(blocks, index, &block->err);
}

int orl_blocks_read(struct orl_blocks *blocks, struct orl_error *err)
{
    orl_parallel_for(blocks->xml->pool, blocks->count, read_one, blocks);
    for (size_t i = 0; i < blocks->count; i++)
        if (blocks->blocks[i].code < 0) {
            if (err)
                *err = blocks->blocks[i].err;
            return blocks->blocks[i].code;
        }
    return 0;
}

void orl_blocks_done(struct orl_blocks *blocks)
{
    for (size_t i = 0; i < blocks->count; i++)
        orl_tree_text_done(&blocks->blocks[i].text);
    blocks->count = 0;
}

/* ---- State of the reader --------------------------------------------------------------------- */

/* Writes the place of the reader for a message: the block with its direction, or the element. */
static void name_place(const struct orl_xml_reader *r, char *ret_name, size_t size)
{
    const enum orl_xml_element here = r->depth > 0 ? r->path[r->depth - 1] : EL_DOCUMENT;
    if (here >= EL_BLOCK && r->part >= 0)
        orl_block_name(r->part, ret_name, size);
    else
        snprintf(ret_name, size, "%s", orl_xml_element_name(here));
}

/* Returns the current line, without the lines in blocks. */
static size_t line_of(const struct orl_xml_reader *r)
{
    return XML_GetCurrentLineNumber(r->parser) + r->passed_lines;
}

void orl_xml_fail(struct orl_xml_reader *r, int code)
{
    char place[ORL_ERROR_NAME_MAX];
    if (r->code < 0)
        return;
    r->code = code;
    name_place(r, place, sizeof place);
    orl_error_at(r->err, r->file, (int)(line_of(r) + orl_blocks_lines(&r->blocks, r->blocks.count)),
                 place);
    XML_StopParser(r->parser, XML_FALSE);
}

double orl_xml_unit_m(const char **attributes)
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

/* ---- Short elements -------------------------------------------------------------------------- */

static void read_structure(struct orl_xml_reader *r)
{
    struct orl_document *d = r->document;
    if (d->structure != ORL_STRUCTURE_NONE)
        FAIL(r, ORL_ERR_SYNTAX, "IncidentDataStructure is given twice");
    else if (!strcasecmp(r->text, "TensorTree4"))
        d->structure = ORL_STRUCTURE_TREE4;
    else if (!strcasecmp(r->text, "TensorTree3"))
        d->structure = ORL_STRUCTURE_TREE3;
    else if (!strcasecmp(r->text, "Columns") || !strcasecmp(r->text, "Rows"))
        d->structure = ORL_STRUCTURE_MATRIX;
    else
        FAIL(r, ORL_ERR_UNSUPPORTED,
             "IncidentDataStructure '%s' is not TensorTree3, TensorTree4, Columns or Rows",
             r->text);
    d->by_rows = !strcasecmp(r->text, "Rows");
}

static void read_thickness(struct orl_xml_reader *r)
{
    double value = 0;
    if (r->text[0] == '\0')
        return;
    if (orl_number_parse(r->text, r->text_length, &value, r->err) < 0 || value < 0) {
        FAIL(r, ORL_ERR_RANGE, "thickness '%s' is not a number from 0 up", r->text);
        return;
    }
    r->document->thickness_m = value * r->thickness_unit;
}

static void read_ring_number(struct orl_xml_reader *r)
{
    const enum orl_xml_element here = r->path[r->depth - 1];
    double *into = here == EL_RING_CELLS   ? &r->ring_cells
                   : here == EL_RING_LOWER ? &r->ring_lower
                                           : &r->ring_upper;
    const int code = orl_number_parse(r->text, r->text_length, into, r->err);
    if (code < 0)
        orl_xml_fail(r, code);
}

/* Returns the flag that is set once the part has that channel. */
static bool *given_flag(struct orl_component *component, int channel)
{
    return channel == 0 ? &component->present : &component->chroma.given[channel - 1];
}

/* Fails and returns true if the part already has data of the channel. Called where the direction is
 * named, and again before the data: the channel may be named in between, and a block may hold data
 * twice. */
static bool is_given(struct orl_xml_reader *r)
{
    if (r->channel < 0 || !*given_flag(&r->document->parts[r->part], r->channel))
        return false;
    FAIL(r, ORL_ERR_SYNTAX, "%s is given twice for %s", orl_component_names[r->part],
         r->channel == 0 ? "Visible" : "the same colour channel");
    return true;
}

static void read_part(struct orl_xml_reader *r)
{
    for (int i = 0; i < ORL_COMPONENT_COUNT; i++)
        if (!strcasecmp(r->text, orl_component_names[i]))
            r->part = i;
    if (r->part < 0)
        FAIL(r, ORL_ERR_SYNTAX, "unknown WavelengthDataDirection '%s'", r->text);
    else
        is_given(r);
}

static void read_basis_name(struct orl_xml_reader *r)
{
    const enum orl_tree_axis axis =
        r->path[r->depth - 1] == EL_COLUMN_BASIS ? ORL_AXIS_A : ORL_AXIS_B;
    if (r->channel < 0)
        return;
    for (unsigned i = 0; i < r->n_bases; i++) {
        if (!strcasecmp(r->bases[i].name, r->text) && r->bases[i].n_rings > 0) {
            r->basis[axis] = r->bases[i];
            r->have_basis[axis] = true;
            return;
        }
    }
    r->have_basis[axis] = orl_basis_standard(r->text, &r->basis[axis]) == 0;
    if (!r->have_basis[axis])
        FAIL(r, ORL_ERR_UNSUPPORTED,
             "angle basis '%s' is neither defined in the file nor a standard one", r->text);
}

static void add_ring(struct orl_xml_reader *r)
{
    const int code = orl_basis_add_ring(&r->bases[r->n_bases - 1], r->ring_lower, r->ring_upper,
                                        r->ring_cells, r->err);
    if (code < 0)
        orl_xml_fail(r, code);
}

/* ---- Scattering data ------------------------------------------------------------------------- */

/* Colour is only evaluated, so its trees need no sums. */
static int begin_tree(struct orl_xml_reader *r, struct orl_component *component)
{
    const int k = r->channel - 1;
    struct orl_tree *tree = k < 0 ? &component->tree : &component->chroma.tree[k];
    struct orl_iso *iso = k < 0 ? &component->iso : &component->chroma.iso[k];
    int code;
    if (!r->tree_basis)
        return orl_error_set(r->err, ORL_ERR_SYNTAX, "a tensor tree without an AngleBasis");
    if (r->document->structure == ORL_STRUCTURE_TREE4) {
        orl_tree_text_init(&r->tree_text, tree, NULL);
        tree->eval_only = k >= 0;
        return 0;
    }
    orl_tree_text_init(&r->tree_text, NULL, iso);
    code = orl_iso_init(iso, r->err);
    iso->eval_only = k >= 0;
    return code;
}

static int begin_matrix(struct orl_xml_reader *r, struct orl_component *component)
{
    struct orl_matrix *matrix =
        r->channel == 0 ? &component->matrix : &component->chroma.matrix[r->channel - 1];
    if (!r->have_basis[0] || !r->have_basis[1])
        return orl_error_set(r->err, ORL_ERR_SYNTAX,
                             "a matrix without ColumnAngleBasis and RowAngleBasis");
    orl_matrix_text_init(&r->matrix_text, matrix, r->document->by_rows);
    return orl_matrix_init(matrix, &r->basis[0], &r->basis[1], r->err);
}

static void begin_data(struct orl_xml_reader *r)
{
    struct orl_component *component;
    int code = 0;
    r->reading = false;
    if (r->channel < 0)
        return;
    if (r->part < 0) {
        FAIL(r, ORL_ERR_SYNTAX, "ScatteringData before WavelengthDataDirection");
        return;
    }
    if (is_given(r))
        return;
    component = &r->document->parts[r->part];
    switch (r->document->structure) {
    case ORL_STRUCTURE_TREE3:
    case ORL_STRUCTURE_TREE4:
        code = begin_tree(r, component);
        break;
    case ORL_STRUCTURE_MATRIX:
        code = begin_matrix(r, component);
        break;
    default:
        code = orl_error_set(r->err, ORL_ERR_SYNTAX, "data before the IncidentDataStructure");
        break;
    }
    if (code < 0)
        orl_xml_fail(r, code);
    else
        r->reading = *given_flag(component, r->channel) = true;
}

bool orl_xml_may_defer(const struct orl_xml_reader *r)
{
    return r->document->structure != ORL_STRUCTURE_MATRIX && r->blocks.count < ORL_BLOCKS_MAX;
}

void orl_xml_defer(struct orl_xml_reader *r, size_t begin, size_t end)
{
    r->blocks.blocks[r->blocks.count++] = (struct orl_block){
        .text = r->tree_text, .begin = begin, .end = end, .line = line_of(r), .part = r->part};
    r->tree_text.grid = NULL; /* now owned by the block */
    r->deferring = true;
}

int orl_xml_read_deferred(struct orl_xml_reader *r)
{
    const size_t last = r->blocks.count - 1;
    struct orl_block *block = &r->blocks.blocks[last];
    const char *const data = r->blocks.xml->data;
    const int code = orl_block_read(&r->blocks, last, r->err);
    if (code < 0) {
        r->code = code;
        XML_StopParser(r->parser, XML_FALSE);
        return code;
    }
    r->tree_text = block->text;
    r->passed_lines += orl_count_lines(data + block->begin, data + block->end);
    r->deferring = false;
    r->blocks.count = last;
    return 0;
}

int orl_xml_feed(struct orl_xml_reader *r, const char *text, size_t length, const char **ret_place)
{
    const bool matrix = r->document->structure == ORL_STRUCTURE_MATRIX;
    const int code = matrix ? orl_matrix_text_feed(&r->matrix_text, text, length, r->err)
                            : orl_tree_text_feed(&r->tree_text, text, length, r->err);
    *ret_place = matrix ? r->matrix_text.scan.next : r->tree_text.scan.next;
    return code;
}

static void end_data(struct orl_xml_reader *r)
{
    int code;
    if (!r->reading)
        return;
    r->reading = false;
    if (r->deferring) {
        r->blocks.blocks[r->blocks.count - 1].ended = true;
        r->deferring = false;
        return;
    }
    code = r->document->structure == ORL_STRUCTURE_MATRIX
               ? orl_matrix_text_finish(&r->matrix_text, r->err)
               : orl_tree_text_finish(&r->tree_text, r->err);
    orl_tree_text_done(&r->tree_text);
    if (code < 0)
        orl_xml_fail(r, code);
}

/* ---- Beginnings and ends --------------------------------------------------------------------- */

void orl_xml_begin(struct orl_xml_reader *r, enum orl_xml_element element, const char **attributes)
{
    if (element == EL_THICKNESS) {
        r->thickness_unit = orl_xml_unit_m(attributes);
    } else if (element == EL_BASIS) {
        if (r->n_bases == ORL_XML_BASES_MAX)
            FAIL(r, ORL_ERR_LIMIT, "more than %d angle bases", ORL_XML_BASES_MAX);
        else
            orl_basis_init(&r->bases[r->n_bases++], "");
    } else if (element == EL_RING) {
        r->ring_cells = r->ring_lower = r->ring_upper = 0;
    } else if (element == EL_WAVELENGTH_DATA) {
        r->channel = -1;
    } else if (element == EL_BLOCK) {
        r->part = -1;
        r->tree_basis = r->have_basis[0] = r->have_basis[1] = false;
    } else if (element == EL_DATA) {
        begin_data(r);
    }
}

static void read_file_type(struct orl_xml_reader *r)
{
    if (strcmp(r->text, "BSDF") != 0)
        FAIL(r, ORL_ERR_SYNTAX, "FileType is '%s', not 'BSDF'", r->text);
}

static void read_name(struct orl_xml_reader *r)
{
    snprintf(r->document->name, sizeof r->document->name, "%.*s", (int)sizeof r->document->name - 1,
             r->text);
}

static void read_basis_title(struct orl_xml_reader *r)
{
    snprintf(r->bases[r->n_bases - 1].name, ORL_BASIS_NAME_MAX, "%.*s", ORL_BASIS_NAME_MAX - 1,
             r->text);
}

static void read_wavelength(struct orl_xml_reader *r)
{
    const bool matrix = r->document->structure == ORL_STRUCTURE_MATRIX;
    if (!strcasecmp(r->text, "Visible"))
        r->channel = 0;
    else if (!strcasecmp(r->text, matrix ? "CIE-X" : "CIE-u"))
        r->channel = 1;
    else if (!strcasecmp(r->text, matrix ? "CIE-Z" : "CIE-v"))
        r->channel = 2;
    else
        r->channel = -1;
}

static void read_tree_basis(struct orl_xml_reader *r)
{
    r->tree_basis = !strcasecmp(r->text, "LBNL/Shirley-Chiu");
    if (r->channel >= 0 && !r->tree_basis)
        FAIL(r, ORL_ERR_UNSUPPORTED, "angle basis '%s' is not supported for a tensor tree",
             r->text);
}

void orl_xml_end(struct orl_xml_reader *r, enum orl_xml_element element)
{
    static void (*const ends[])(struct orl_xml_reader *) = {
        [EL_FILE_TYPE] = read_file_type,
        [EL_NAME] = read_name,
        [EL_THICKNESS] = read_thickness,
        [EL_STRUCTURE] = read_structure,
        [EL_BASIS_NAME] = read_basis_title,
        [EL_RING_CELLS] = read_ring_number,
        [EL_RING_LOWER] = read_ring_number,
        [EL_RING_UPPER] = read_ring_number,
        [EL_RING] = add_ring,
        [EL_WAVELENGTH] = read_wavelength,
        [EL_DIRECTION] = read_part,
        [EL_COLUMN_BASIS] = read_basis_name,
        [EL_ROW_BASIS] = read_basis_name,
        [EL_TREE_BASIS] = read_tree_basis,
        [EL_DATA] = end_data,
    };
    if (ends[element])
        ends[element](r);
}
