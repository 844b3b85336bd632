/*
 * Streams a BSDF file through expat. Elements are recognised by their place in the document (a
 * table of parent and name); unknown ones are skipped with their contents. A DTD, and with it any
 * entity defined in the file, is refused before it is read.
 */
#include "bsdf/xml/xml.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/scanner.h>
#include <oriel/base/thread_pool.h>

enum { SLICE_LEAST = 1 << 16, SLICE_MOST = 1 << 20, SLICE_OF_TOKEN = 1 << 28 };

/* ---- Expat's callbacks ----------------------------------------------------------------------- */

static enum orl_xml_element element_at(struct orl_xml_reader *r, const char *name)
{
    const enum orl_xml_element parent = r->depth > 0 ? r->path[r->depth - 1] : EL_DOCUMENT;
    const enum orl_xml_element element = orl_xml_element_in(parent, name);
    /* Only the first layer of a file is read, as in Radiance. */
    return element == EL_LAYER && r->layers++ > 0 ? EL_OTHER : element;
}

static void on_start(void *ctx, const XML_Char *name, const XML_Char **attributes)
{
    struct orl_xml_reader *r = ctx;
    enum orl_xml_element element;
    if (r->code < 0)
        return;
    element = element_at(r, name);
    if (r->depth == 0 && element != EL_WINDOW) {
        FAIL(r, ORL_ERR_SYNTAX, "the file is not a BSDF: its root is '%.64s', not 'WindowElement'",
             name);
        return;
    }
    if (r->depth == ORL_LIMIT_XML_DEPTH) {
        FAIL(r, ORL_ERR_LIMIT, "elements are nested deeper than %u", ORL_LIMIT_XML_DEPTH);
        return;
    }
    r->path[r->depth++] = element;
    r->text_length = 0;
    orl_xml_begin(r, element, attributes);
}

static void on_text(void *ctx, const XML_Char *text, int length)
{
    struct orl_xml_reader *r = ctx;
    size_t room = ORL_XML_TEXT_MAX - 1 - r->text_length, count = (size_t)length;
    if (r->code < 0)
        return;
    if (r->reading && r->path[r->depth - 1] == EL_DATA) {
        const char *place;
        if (r->deferring && orl_xml_read_deferred(r) < 0)
            return;
        const int code = orl_xml_feed(r, text, count, &place);
        if (code < 0)
            orl_xml_fail(r, code);
        r->plain = text + count == r->fed_to;
        return;
    }
    if (count > room) /* longer than any known name, so it matches none */
        count = room;
    memcpy(r->text + r->text_length, text, count);
    r->text_length += count;
}

/* Trims white space from both ends of the text and terminates it. */
static void trim_text(struct orl_xml_reader *r)
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

static void on_end(void *ctx, const XML_Char *name)
{
    struct orl_xml_reader *r = ctx;
    (void)name;
    if (r->code < 0)
        return;
    trim_text(r);
    orl_xml_end(r, r->path[r->depth - 1]);
    r->depth--;
    r->text_length = 0;
}

static void on_doctype(void *ctx, const XML_Char *name, const XML_Char *system,
                       const XML_Char *public, int internal)
{
    struct orl_xml_reader *r = ctx;
    (void)name, (void)system, (void)public, (void)internal;
    FAIL(r, ORL_ERR_UNSUPPORTED, "a document type declaration; entities are not accepted");
}

/* ---- The whole ------------------------------------------------------------------------------- */

/* Returns the length of plain text before the next markup, at most length. */
static size_t plain_length(const char *text, size_t length)
{
    const char *markup = memchr(text, '<', length);
    if (markup)
        length = (size_t)(markup - text);
    markup = memchr(text, '&', length);
    return markup ? (size_t)(markup - text) : length;
}

/*
 * Reads data past expat. Most of a file is data in plain text. If a piece ends inside data, the
 * text up to the next markup is deferred to a block if possible. Otherwise it is parsed directly,
 * which halves the time. Returns its length. Expat continues behind it and does not count its
 * lines.
 */
static size_t read_plain(struct orl_xml_reader *r, size_t at)
{
    const bool put_off = orl_xml_may_defer(r);
    const char *const text = r->blocks.xml->data + at, *end = text;
    const size_t left = r->blocks.xml->size - at;
    const size_t most = put_off || left < SLICE_LEAST ? left : SLICE_LEAST;
    const size_t length = plain_length(text, most);
    r->plain = !put_off && length == SLICE_LEAST;
    if (put_off) {
        orl_xml_defer(r, at, at + length);
        return length;
    }
    const int code = orl_xml_feed(r, text, length, &end);
    r->passed_lines += orl_count_lines(text, end);
    if (code < 0)
        orl_xml_fail(r, code);
    return length;
}

static void refuse_xml(struct orl_xml_reader *r, bool last)
{
    const enum XML_Error error = XML_GetErrorCode(r->parser);
    FAIL(r, error == XML_ERROR_NO_MEMORY ? ORL_ERR_NOMEM : ORL_ERR_SYNTAX, "XML: %s",
         XML_ErrorString(error));
    if (error == XML_ERROR_UNKNOWN_ENCODING)
        orl_error_hint(r->err,
                       "save the file as UTF-8, and declare that encoding in its first line");
    else if (error == XML_ERROR_INVALID_TOKEN)
        orl_error_hint(r->err, "non-ASCII characters must be in UTF-8: save the file as UTF-8");
    else if (last)
        orl_error_hint(r->err, "the file may be truncated");
}

/*
 * Returns the offset of the XML, after any messages that programs such as genBSDF write before it.
 * expat handles a byte order mark. Nothing is skipped in UTF-16 without a mark, which contains
 * zeros.
 */
static size_t find_xml(const struct orl_bsdf_xml *xml)
{
    const char *const data = xml->data;
    if (xml->size == 0 || (unsigned char)*data >= 0xef || *data == '\0')
        return 0;
    const char *const first = memchr(data, '<', xml->size);
    return first ? (size_t)(first - data) : 0;
}

/* Returns the size without a trailing Ctrl-Z, with which old programs mark the end. */
static size_t find_end(const struct orl_bsdf_xml *xml)
{
    size_t end = xml->size;
    while (end > 0 &&
           (xml->data[end - 1] == 0x1a || orl_byte_kind_of(xml->data[end - 1]) != ORL_BYTE_WORD))
        end--;
    return end < xml->size && memchr(xml->data + end, 0x1a, xml->size - end) ? end : xml->size;
}

/* Passes a slice of the file to expat, and sets the line of expat's own errors. */
static void parse_slice(struct orl_xml_reader *r, const char *slice, size_t size, bool last)
{
    char *piece = XML_GetBuffer(r->parser, (int)(size > 0 ? size : 1));
    r->plain = false;
    if (piece) {
        memcpy(piece, slice, size);
        r->fed_to = piece + size;
    }
    if ((!piece || XML_ParseBuffer(r->parser, (int)size, last) == XML_STATUS_ERROR) && r->code == 0)
        refuse_xml(r, last);
}

/* Reports progress to the XML's `passed` callback, in steps of at least SLICE_MOST bytes. */
static void report_passed(const struct orl_bsdf_xml *xml, size_t at, size_t *told)
{
    if (!xml->passed || (at - *told < SLICE_MOST && at < xml->size))
        return;
    xml->passed(xml->ctx, *told, at);
    *told = at;
}

static void check_cancel(struct orl_xml_reader *r, const struct orl_bsdf_xml *xml)
{
    if (r->code == 0 && orl_is_cancelled(xml->cancel))
        r->code = orl_error_set(r->err, ORL_ERR_CANCELLED, "cancelled while reading the BSDF");
}

/*
 * Parses the whole file. Expat reads an incomplete token again with each slice, so slices grow.
 * They grow further while expat does not advance, as in a comment of many megabytes.
 */
static void parse_file(struct orl_xml_reader *r, const struct orl_bsdf_xml *xml)
{
    size_t at = find_xml(xml), slice = SLICE_LEAST, told = 0;
    XML_Index reached = -1;
    bool last = false;
    r->document->skipped_bytes = at;
    r->passed_lines = orl_count_lines(xml->data, xml->data + at);
    while (r->code == 0 && !last) {
        const size_t length = xml->size - at < slice ? xml->size - at : slice;
        last = length == xml->size - at;
        parse_slice(r, xml->data + at, length, last);
        at += length;
        report_passed(xml, at, &told);
        check_cancel(r, xml);
        const XML_Index before = reached;
        reached = XML_GetCurrentByteIndex(r->parser);
        if (slice < SLICE_MOST || (reached == before && slice < SLICE_OF_TOKEN))
            slice *= 2;
        else if (reached != before)
            slice = SLICE_MOST;
        while (r->code == 0 && r->plain && !last) {
            at += read_plain(r, at);
            if (r->deferring) /* the block's reader reports its progress */
                told = at;
            report_passed(xml, at, &told);
            check_cancel(r, xml);
            slice = SLICE_LEAST;
        }
    }
}

static int check_complete(const struct orl_document *d, const char *file, struct orl_error *err)
{
    int code = 0;
    bool any = false;
    for (int i = 0; i < ORL_COMPONENT_COUNT; i++)
        any |= d->parts[i].present;
    if (d->structure == ORL_STRUCTURE_NONE)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "no IncidentDataStructure in the file");
    else if (!any)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "no scattering data for Visible in the file");
    if (code < 0)
        orl_error_at(err, file, 0, "WindowElement");
    return code;
}

int orl_document_read(const struct orl_bsdf_xml *xml, struct orl_document *ret_document,
                      struct orl_error *err)
{
    struct orl_bsdf_xml whole = *xml;
    struct orl_error ignored;
    struct orl_xml_reader *r = calloc(1, sizeof *r);
    struct orl_document *document = calloc(1, sizeof *document);
    int code = ORL_ERR_NOMEM;
    if (r)
        r->parser = XML_ParserCreate(NULL);
    if (!r || !document || !r->parser) {
        orl_error_set(err, code, "out of memory reading the BSDF");
        orl_error_at(err, xml->name, 0, NULL);
        goto done;
    }
    r->document = document;
    r->err = err ? err : &ignored;
    r->file = xml->name;
    r->part = r->channel = -1;
    XML_SetUserData(r->parser, r);
    XML_SetElementHandler(r->parser, on_start, on_end);
    XML_SetCharacterDataHandler(r->parser, on_text);
    XML_SetStartDoctypeDeclHandler(r->parser, on_doctype);
    whole.size = find_end(xml);
    r->blocks.xml = &whole;
    parse_file(r, &whole);
    /* An error in a deferred block comes before the error at which parsing stopped. */
    code = r->code == ORL_ERR_CANCELLED ? r->code : orl_blocks_read(&r->blocks, err);
    if (code == 0)
        code = r->code;
    if (code == 0)
        code = check_complete(document, xml->name, err);
    if (code == 0) {
        *ret_document = *document;
        memset(document, 0, sizeof *document);
    }
done:
    if (r) {
        orl_tree_text_done(&r->tree_text);
        orl_blocks_done(&r->blocks);
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
    for (int i = 0; i < ORL_COMPONENT_COUNT; i++)
        orl_component_done(&document->parts[i]);
    memset(document, 0, sizeof *document);
}
