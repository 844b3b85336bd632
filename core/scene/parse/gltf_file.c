#include "scene/parse/gltf_file.h"

#include <stdlib.h>
#include <string.h>

enum { NAME_BYTES = 4096 };

struct opened {
    struct aiFile file; /* first: Assimp hands back its address */
    const char *data;
    size_t size, at;
};

static size_t read_some(struct aiFile *file, char *buffer, size_t size, size_t count)
{
    struct opened *opened = (struct opened *)file;
    const size_t left = size > 0 ? (opened->size - opened->at) / size : 0;
    const size_t n = count < left ? count : left;
    if (n > 0)
        memcpy(buffer, opened->data + opened->at, n * size);
    opened->at += n * size;
    return n;
}

static size_t write_none(struct aiFile *file, const char *buffer, size_t size, size_t count)
{
    (void)file, (void)buffer, (void)size, (void)count;
    return 0;
}

static size_t tell(struct aiFile *file)
{
    return ((struct opened *)file)->at;
}

static size_t size_of(struct aiFile *file)
{
    return ((struct opened *)file)->size;
}

static enum aiReturn seek(struct aiFile *file, size_t offset, enum aiOrigin origin)
{
    struct opened *opened = (struct opened *)file;
    const size_t from = origin == aiOrigin_SET   ? 0
                        : origin == aiOrigin_CUR ? opened->at
                                                 : opened->size;
    if (offset > opened->size - from)
        return aiReturn_FAILURE;
    opened->at = from + offset;
    return aiReturn_SUCCESS;
}

static void flush_none(struct aiFile *file)
{
    (void)file;
}

/* "a%20b" is "a b". */
static void decode_name(const char *name, char ret_name[NAME_BYTES])
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
}

static struct aiFile *open_file(struct aiFileIO *io, const char *name, const char *mode)
{
    struct orl_gltf_files *files = (struct orl_gltf_files *)(void *)io->UserData;
    struct orl_file file = files->file;
    char decoded[NAME_BYTES];
    (void)mode; /* nothing is written */
    decode_name(name, decoded);
    if (files->code == 0 && strcmp(name, files->name) != 0)
        files->code = files->buffers->open(files->buffers->ctx, decoded, &file, &files->err);
    struct opened *opened = files->code == 0 ? calloc(1, sizeof *opened) : NULL;
    if (!opened && files->code == 0)
        files->code = orl_error_set(&files->err, ORL_ERR_NOMEM, "out of memory for a glTF file");
    if (!opened)
        return NULL;
    opened->file = (struct aiFile){.ReadProc = read_some,
                                   .WriteProc = write_none,
                                   .TellProc = tell,
                                   .FileSizeProc = size_of,
                                   .SeekProc = seek,
                                   .FlushProc = flush_none};
    opened->data = file.data;
    opened->size = file.size;
    return &opened->file;
}

static void close_file(struct aiFileIO *io, struct aiFile *file)
{
    (void)io;
    free(file);
}

struct aiFileIO orl_gltf_file_io(struct orl_gltf_files *files)
{
    return (struct aiFileIO){
        .OpenProc = open_file, .CloseProc = close_file, .UserData = (aiUserData)(void *)files};
}
