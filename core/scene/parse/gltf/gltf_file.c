#include "scene/parse/gltf/gltf_file.h"

#include <errno.h>
#include <math.h>
#include <sodium.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/json_read.h>
#include <oriel/base/limits.h>

void orl_gltf_refuse(const struct orl_gltf_item *at, int code, const char *hint, const char *format,
                     ...)
{
    struct orl_gltf_file *const file = at->file;
    va_list args;
    if (file->code)
        return;
    va_start(args, format);
    file->code = orl_error_vset(file->err, code, format, args);
    va_end(args);
    orl_error_hint(file->err, "%s", hint);
    orl_error_at(file->err, file->name, 0, at->name);
}

void orl_gltf_no_memory(struct orl_gltf_file *file)
{
    file->code = orl_error_set(file->err, ORL_ERR_NOMEM, "out of memory for a glTF file");
}

struct orl_gltf_item orl_gltf_find(const struct orl_gltf_item *at, const char *list, size_t index)
{
    const json_t *const all = json_object_get(at->file->document, list);
    struct orl_gltf_item item = {at->file, json_array_get(all, index), ""};
    snprintf(item.name, sizeof item.name, "%s[%zu]", list, index);
    if (!json_is_object(item.object))
        orl_gltf_fail(at, ORL_ERR_SYNTAX, "it refers to %s[%zu], which does not exist", list,
                      index);
    return item;
}

static struct orl_gltf_item find_inner(const struct orl_gltf_item *at, const char *key)
{
    struct orl_gltf_item inner = {at->file, json_object_get(at->object, key), ""};
    snprintf(inner.name, sizeof inner.name, "%.50s%s%.30s", at->name, at->name[0] ? "." : "", key);
    return inner;
}

struct orl_gltf_item orl_gltf_element(const struct orl_gltf_item *at, const char *list,
                                      size_t index)
{
    const struct orl_gltf_item all = find_inner(at, list);
    struct orl_gltf_item part = {at->file, json_array_get(all.object, index), ""};
    snprintf(part.name, sizeof part.name, "%.70s[%zu]", all.name, index);
    if (!json_is_object(part.object))
        orl_gltf_fail(&part, ORL_ERR_SYNTAX, "an object is expected here");
    return part;
}

struct orl_gltf_item orl_gltf_member(const struct orl_gltf_item *at, const char *key)
{
    const struct orl_gltf_item inner = find_inner(at, key);
    if (inner.object && !json_is_object(inner.object))
        orl_gltf_fail(&inner, ORL_ERR_SYNTAX, "an object is expected here");
    return inner;
}

size_t orl_gltf_length(const struct orl_gltf_item *at, const char *list)
{
    const struct orl_gltf_item all = find_inner(at, list);
    if (all.object && !json_is_array(all.object))
        orl_gltf_fail(&all, ORL_ERR_SYNTAX, "a list is expected here");
    return json_array_size(all.object);
}

static bool read_whole(const json_t *value, size_t *ret_value)
{
    const double number = json_number_value(value);
    if (!json_is_number(value) || !(number >= 0 && number <= 0x1p53) || number != floor(number))
        return false;
    *ret_value = (size_t)number;
    return true;
}

size_t orl_gltf_integer(const struct orl_gltf_item *at, const char *key, size_t absent)
{
    const json_t *const member = json_object_get(at->object, key);
    if (member && !read_whole(member, &absent))
        orl_gltf_fail(at, ORL_ERR_SYNTAX, "'%s' is not a whole number from 0 up", key);
    return absent;
}

size_t orl_gltf_integer_in_list(const struct orl_gltf_item *at, const char *list, size_t i)
{
    size_t value = 0;
    if (!read_whole(json_array_get(json_object_get(at->object, list), i), &value))
        orl_gltf_fail(at, ORL_ERR_SYNTAX, "'%s' has a member that is not a whole number from 0 up",
                      list);
    return value;
}

bool orl_gltf_numbers(const struct orl_gltf_item *at, const char *key, size_t n, double *values)
{
    const json_t *const array = json_object_get(at->object, key);
    bool sound = json_is_array(array) && json_array_size(array) == n;
    for (size_t i = 0; sound && i < n; i++) {
        const json_t *const value = json_array_get(array, i);
        sound = json_is_number(value);
        values[i] = json_number_value(value);
    }
    if (array && !sound)
        orl_gltf_fail(at, ORL_ERR_SYNTAX, "'%s' is not %zu numbers", key, n);
    return array != NULL;
}

const char *orl_gltf_text(const struct orl_gltf_item *at, const char *key)
{
    return json_string_value(json_object_get(at->object, key));
}

enum { CHUNK_HEAD = 8, GLB_HEAD = 12, NAME_BYTES = 4096 };

static const char as_version_2[] = "export it again as glTF 2.0";

/* ---- Containers ------------------------------------------------------------------------------ */

static bool is_binary(const char *data, size_t size)
{
    return size >= GLB_HEAD && memcmp(data, "glTF", 4) == 0;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/* Returns the offset behind a byte order mark and blanks. */
static size_t find_text(const char *data, size_t size)
{
    size_t at = size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    while (at < size && is_blank(data[at]))
        at++;
    return at;
}

bool orl_gltf_detect(const char *data, size_t size)
{
    const size_t at = find_text(data, size);
    return is_binary(data, size) || (at < size && data[at] == '{');
}

/* Reads the chunks of a .glb: returns the JSON, which is the first; sets BIN. */
static struct orl_gltf_bytes read_chunks(struct orl_gltf_file *file, const char *data, size_t size)
{
    static const char cut[] = "the file is truncated: copy or export it again";
    struct orl_gltf_bytes json = {NULL, 0};
    const size_t whole = orl_u32_at(data + 8);
    size_t at = GLB_HEAD;
    if (orl_u32_at(data + 4) != 2)
        orl_gltf_refuse(&file->root, ORL_ERR_UNSUPPORTED, as_version_2,
                        "this is glTF, but not version 2");
    else if (whole > size)
        orl_gltf_refuse(&file->root, ORL_ERR_SYNTAX, cut, "its header gives a longer file");
    while (!file->code && at <= whole && whole - at >= CHUNK_HEAD) {
        const size_t length = orl_u32_at(data + at);
        const char *const type = data + at + 4;
        const struct orl_gltf_bytes chunk = {(const unsigned char *)type + 4, length};
        if (length > whole - at - CHUNK_HEAD)
            orl_gltf_refuse(&file->root, ORL_ERR_SYNTAX, cut,
                            "one of its chunks extends beyond the file's end");
        else if (at == GLB_HEAD && memcmp(type, "JSON", 4) == 0)
            json = chunk;
        else if (!file->chunk.data && memcmp(type, "BIN", 4) == 0)
            file->chunk = chunk;
        at += CHUNK_HEAD + length;
    }
    if (!json.data)
        orl_gltf_refuse(&file->root, ORL_ERR_SYNTAX, as_version_2, "its first chunk is not JSON");
    return json;
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static void read_json(struct orl_gltf_file *file, const char *text, size_t size)
{
    json_error_t where;
    const size_t begin = find_text(text, size);
    while (size > begin && (text[size - 1] == '\0' || is_blank(text[size - 1])))
        size--; /* strips the chunk's padding */
    if (orl_json_memory_estimate(text + begin, size - begin) > ORL_LIMIT_JSON_MEMORY) {
        orl_gltf_refuse(&file->root, ORL_ERR_LIMIT,
                        "export it as .glb, or split it into several files",
                        "its JSON has too many values");
        return;
    }
    file->document = orl_json_read(text + begin, size - begin, JSON_REJECT_DUPLICATES, &where);
    if (!file->document && errno == ENOMEM)
        orl_gltf_no_memory(file);
    else if (!file->document)
        orl_gltf_fail(&file->root, ORL_ERR_SYNTAX,
                      "this is not a readable glTF 2.0 file: JSON line %d, column %d: %s",
                      where.line, where.column, where.text);
    file->root.object = file->document;
}

static void check_version(const struct orl_gltf_file *file)
{
    const struct orl_gltf_item asset = orl_gltf_member(&file->root, "asset");
    const char *const version = orl_gltf_text(&asset, "version");
    const char *const least = orl_gltf_text(&asset, "minVersion");
    if (!version)
        orl_gltf_refuse(&file->root, ORL_ERR_SYNTAX, as_version_2,
                        "this is not a readable glTF 2.0 file: "
                        "it has no 'asset' with a 'version'");
    else if (version[0] != '2' || (version[1] && version[1] != '.') ||
             (least && strcmp(least, "2.0") != 0))
        orl_gltf_refuse(&file->root, ORL_ERR_UNSUPPORTED, as_version_2,
                        "this is glTF, but not version 2.0");
}

/* Returns true for extensions that only concern ignored content (colours, textures, lights), or
 * that are supported. */
static bool is_known(const char *name)
{
    static const char *const known[] = {"KHR_materials_",
                                        "KHR_texture_",
                                        "KHR_lights_",
                                        "EXT_lights_",
                                        "EXT_texture_",
                                        "MSFT_texture_",
                                        "KHR_technique",
                                        "KHR_xmp",
                                        "KHR_animation_",
                                        "KHR_mesh_quantization",
                                        "EXT_mesh_gpu_instancing"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strncmp(name, known[i], strlen(known[i])) == 0)
            return true;
    return false;
}

static void check_extensions(const struct orl_gltf_file *file)
{
    static const char list[] = "extensionsRequired";
    const json_t *const names = json_object_get(file->document, list);
    const size_t count = orl_gltf_length(&file->root, list);
    for (size_t i = 0; i < count; i++) {
        const char *const name = json_string_value(json_array_get(names, i));
        if (!name || !is_known(name))
            orl_gltf_refuse(&file->root, ORL_ERR_UNSUPPORTED,
                            "export it without this extension, for example without compression",
                            "the extension '%.80s' is not supported", name ? name : "");
    }
}

/* ---- Buffers --------------------------------------------------------------------------------- */

/* Decodes "a%20b" to "a b"; false if the name is too long. */
static bool decode_name(const char *name, char ret_name[NAME_BYTES])
{
    size_t n = 0;
    for (; *name && n + 1 < NAME_BYTES; name++) {
        char digits[3] = {0}, *end = digits;
        if (*name == '%' && name[1])
            memcpy(digits, name + 1, 2);
        const long byte = strtol(digits, &end, 16);
        if (end == digits + 2 && byte > 0)
            name += 2;
        ret_name[n++] = end == digits + 2 && byte > 0 ? (char)byte : *name;
    }
    ret_name[n] = '\0';
    return *name == '\0';
}

/* Decodes "data:...;base64,...", with or without '=' at its end. */
static void decode_text(const struct orl_gltf_item *at, const char *uri,
                        struct orl_gltf_buffer *buffer)
{
    static const char mark[] = ";base64";
    const char *const comma = strchr(uri, ',');
    if (!comma || (size_t)(comma - uri) < sizeof mark - 1 ||
        memcmp(comma - (sizeof mark - 1), mark, sizeof mark - 1) != 0) {
        orl_gltf_fail(at, ORL_ERR_UNSUPPORTED, "the data in its 'uri' are not base64");
        return;
    }
    size_t length = strlen(comma + 1);
    while (length > 0 && comma[length] == '=')
        length--;
    buffer->bytes.data = buffer->decoded = malloc(length / 4 * 3 + 3);
    if (!buffer->decoded)
        orl_gltf_no_memory(at->file);
    else if (sodium_base642bin(buffer->decoded, length / 4 * 3 + 3, comma + 1, length, NULL,
                               &buffer->bytes.size, NULL,
                               sodium_base64_VARIANT_ORIGINAL_NO_PADDING) != 0)
        orl_gltf_fail(at, ORL_ERR_SYNTAX, "its base64 data are invalid");
}

static struct orl_gltf_bytes open_external(const struct orl_gltf_item *at, const char *uri)
{
    struct orl_gltf_file *const file = at->file;
    struct orl_file opened = {0};
    char name[NAME_BYTES];
    if (!decode_name(uri, name)) {
        orl_gltf_fail(at, ORL_ERR_LIMIT, "its 'uri' is too long");
    } else {
        file->code = file->external->open(file->external->ctx, name, &opened, file->err);
        if (file->code)
            orl_error_at(file->err, file->name, 0, at->name);
    }
    return (struct orl_gltf_bytes){(const unsigned char *)opened.data, opened.size};
}

static void open_buffer(const struct orl_gltf_item *at, size_t index,
                        struct orl_gltf_buffer *buffer)
{
    const char *const uri = orl_gltf_text(at, "uri");
    const size_t length = orl_gltf_integer(at, "byteLength", 0);
    if (at->file->code)
        return;
    if (uri && strncmp(uri, "data:", 5) == 0)
        decode_text(at, uri, buffer);
    else if (uri)
        buffer->bytes = open_external(at, uri);
    else if (index == 0 && at->file->chunk.data)
        buffer->bytes = at->file->chunk;
    else
        orl_gltf_fail(at, ORL_ERR_SYNTAX, "it has neither a 'uri' nor a binary chunk");
    if (buffer->bytes.size < length)
        orl_gltf_fail(at, ORL_ERR_SYNTAX, "it has %zu bytes, but states %zu", buffer->bytes.size,
                      length);
    buffer->bytes.size = length;
}

struct orl_gltf_bytes orl_gltf_buffer(const struct orl_gltf_item *at, size_t index)
{
    struct orl_gltf_file *const file = at->file;
    const struct orl_gltf_item item = orl_gltf_find(at, "buffers", index);
    if (!file->code && !file->buffers[index].bytes.data)
        open_buffer(&item, index, &file->buffers[index]);
    return file->code ? (struct orl_gltf_bytes){NULL, 0} : file->buffers[index].bytes;
}

/* ---- The file -------------------------------------------------------------------------------- */

void orl_gltf_step(const struct orl_gltf_item *at, uint64_t steps)
{
    at->file->steps += steps;
    if (at->file->steps > ORL_LIMIT_SURFACES)
        orl_gltf_refuse(
            at, ORL_ERR_LIMIT, "export less of it, or repeat parts of it with octree instances",
            "here the file exceeds %lu triangles, counting every use of a mesh and sparse vertices",
            ORL_LIMIT_SURFACES);
}

void orl_gltf_file_open(struct orl_gltf_file *file, const char *name, const char *data, size_t size,
                        const struct orl_gltf_buffers *external, struct orl_error *err)
{
    struct orl_gltf_bytes json = {(const unsigned char *)data, size};
    *file =
        (struct orl_gltf_file){.name = name, .err = err, .root.file = file, .external = external};
    if (is_binary(data, size))
        json = read_chunks(file, data, size);
    if (!file->code)
        read_json(file, (const char *)json.data, json.size);
    check_version(file);
    check_extensions(file);
    file->n_buffers = orl_gltf_length(&file->root, "buffers");
    file->buffers = calloc(file->n_buffers + 1, sizeof *file->buffers);
    if (!file->buffers)
        orl_gltf_no_memory(file);
}

void orl_gltf_file_done(struct orl_gltf_file *file)
{
    for (size_t i = 0; file->buffers && i < file->n_buffers; i++)
        free(file->buffers[i].decoded);
    free(file->buffers);
    json_decref(file->document);
}
