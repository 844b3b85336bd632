#include "bsdf/xml/bsdf_xml.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory/memory.h"
#include "base/text/words.h"
#include "bsdf/xml/xml.h"

enum { DEPTH_MAX = 8, TEXT_MAX = 256, SLICE = 1 << 20 };

/* Parser state. Elements deeper than the path are ignored. */
struct reading {
    XML_Parser parser;
    struct orl_bsdf_geometry *file_geometry;
    struct orl_error *err;
    const char *file;
    int code;
    char path[DEPTH_MAX][24];
    unsigned depth, layers;
    double unit;
    char text[TEXT_MAX];
    size_t length, geometry_room;
};

static void fail_at_line(struct reading *r, int code)
{
    orl_error_at(r->err, r->file, (int)XML_GetCurrentLineNumber(r->parser), NULL);
    r->code = code;
    XML_StopParser(r->parser, XML_FALSE);
}

/* Returns true at an element of the first layer with this name, inside the named outer element. */
static bool is_at(const struct reading *r, const char *outer, const char *name)
{
    return r->depth == 5 && r->layers == 1 && strcmp(r->path[2], "Layer") == 0 &&
           strcmp(r->path[3], outer) == 0 && strcmp(r->path[4], name) == 0;
}

static void on_start(void *ctx, const XML_Char *name, const XML_Char **attributes)
{
    struct reading *r = ctx;
    if (r->depth < DEPTH_MAX) {
        strncpy(r->path[r->depth], name, sizeof r->path[0] - 1);
        r->path[r->depth][sizeof r->path[0] - 1] = '\0';
    }
    r->depth++;
    r->length = 0;
    r->layers += r->depth == 3 && strcmp(name, "Layer") == 0;
    if (r->depth == 5)
        r->unit = orl_xml_unit_m(attributes);
    if (is_at(r, "Geometry", "MGFblock"))
        r->file_geometry->geometry_line = (int)XML_GetCurrentLineNumber(r->parser);
    if (r->depth != 4 || r->layers != 1 || strcmp(name, "Geometry") != 0)
        return;
    for (; attributes[0]; attributes += 2)
        if (strcmp(attributes[0], "format") == 0 && strcasecmp(attributes[1], "MGF") != 0)
            fail_at_line(r, orl_error_set(r->err, ORL_ERR_UNSUPPORTED,
                                          "geometry format '%.40s' is not supported, only MGF",
                                          attributes[1]));
}

static void add_geometry(struct reading *r, const char *text, size_t length)
{
    struct orl_bsdf_geometry *file_geometry = r->file_geometry;
    if (!orl_array_reserve_more(&file_geometry->geometry, &r->geometry_room,
                                file_geometry->geometry_size, length + 1, 1)) {
        fail_at_line(r, orl_error_set(r->err, ORL_ERR_NOMEM, "out of memory"));
        return;
    }
    memcpy(file_geometry->geometry + file_geometry->geometry_size, text, length);
    file_geometry->geometry_size += length;
}

static void on_text(void *ctx, const XML_Char *text, int length)
{
    struct reading *r = ctx;
    const size_t room = TEXT_MAX - 1 - r->length;
    size_t count = (size_t)length;
    if (r->code < 0)
        return;
    if (is_at(r, "Geometry", "MGFblock"))
        add_geometry(r, text, count);
    count = count < room ? count : room;
    memcpy(r->text + r->length, text, count);
    r->length += count;
}

/* Returns the element's text without white space around it, terminated by NUL. */
static const char *trimmed(struct reading *r)
{
    size_t start = 0;
    while (r->length > 0 && strchr(" \t\r\n", r->text[r->length - 1]))
        r->length--;
    r->text[r->length] = '\0';
    start = strspn(r->text, " \t\r\n");
    return r->text + start;
}

static void read_size(struct reading *r, const char *text, double *ret_m)
{
    double value = 0;
    if (*text == '\0')
        return;
    if (orl_number_read(text, strlen(text), &value) != ORL_NUMBER_OK || value < 0)
        fail_at_line(
            r, orl_error_set(r->err, ORL_ERR_RANGE, "%s is '%.40s', not a size", r->path[4], text));
    else
        *ret_m = value * r->unit;
}

static void on_end(void *ctx, const XML_Char *name)
{
    struct reading *r = ctx;
    struct orl_bsdf_geometry *file_geometry = r->file_geometry;
    (void)name;
    if (r->code < 0)
        return;
    const char *const text = trimmed(r);
    if (is_at(r, "Material", "Width"))
        read_size(r, text, &file_geometry->width);
    else if (is_at(r, "Material", "Height"))
        read_size(r, text, &file_geometry->height);
    else if (is_at(r, "Material", "Thickness"))
        read_size(r, text, &file_geometry->thickness);
    else if (is_at(r, "Geometry", "MGFblock"))
        file_geometry->geometry_unit = r->unit;
    r->depth--;
    r->length = 0;
}

static void on_doctype(void *ctx, const XML_Char *name, const XML_Char *system,
                       const XML_Char *public, int internal)
{
    struct reading *r = ctx;
    (void)name, (void)system, (void)public, (void)internal;
    fail_at_line(r, orl_error_set(r->err, ORL_ERR_UNSUPPORTED,
                                  "a document type declaration; entities are not accepted"));
}

static void parse_xml(struct reading *r, const char *xml, size_t size)
{
    for (size_t at = 0; r->code == 0 && at < size; at += SLICE) {
        const size_t length = size - at < SLICE ? size - at : SLICE;
        const bool last = at + length == size;
        if (XML_Parse(r->parser, xml + at, (int)length, last) == XML_STATUS_ERROR && r->code == 0)
            fail_at_line(r, orl_error_set(r->err, ORL_ERR_SYNTAX, "XML: %s",
                                          XML_ErrorString(XML_GetErrorCode(r->parser))));
    }
}

/* Terminates the geometry; drops it if it is only white space. */
static void end_geometry(struct orl_bsdf_geometry *file_geometry)
{
    if (!file_geometry->geometry)
        return;
    file_geometry->geometry[file_geometry->geometry_size] = '\0';
    if (file_geometry->geometry[strspn(file_geometry->geometry, " \t\r\n")] != '\0')
        return;
    free(file_geometry->geometry);
    file_geometry->geometry = NULL;
    file_geometry->geometry_size = 0;
}

int orl_bsdf_geometry_read(const char *name, const char *xml, size_t size,
                           struct orl_bsdf_geometry *ret_geometry, struct orl_error *err)
{
    struct reading r = {.file_geometry = ret_geometry, .err = err, .file = name};
    *ret_geometry = (struct orl_bsdf_geometry){0};
    r.parser = XML_ParserCreate(NULL);
    if (!r.parser)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    XML_SetUserData(r.parser, &r);
    XML_SetElementHandler(r.parser, on_start, on_end);
    XML_SetCharacterDataHandler(r.parser, on_text);
    XML_SetStartDoctypeDeclHandler(r.parser, on_doctype);
    parse_xml(&r, xml, size);
    XML_ParserFree(r.parser);
    end_geometry(ret_geometry);
    return r.code;
}

void orl_bsdf_geometry_done(struct orl_bsdf_geometry *file_geometry)
{
    free(file_geometry->geometry);
    *file_geometry = (struct orl_bsdf_geometry){0};
}
