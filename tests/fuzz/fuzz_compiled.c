/*
 * Compiled BSDF files (the loaded form, cached on disk). The input describes damage to a sound
 * file: edits of four bytes, two for the place (times eight), one for the operation, one for its
 * operand. Damaged files are refused; an accepted file is sound.
 */
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "bsdf/loaded_bsdf.h"
#include "fixtures/bsdf_make.h"
#include "fuzz/fuzz.h"

enum { EDIT = 4, MOST = 1 << 20 };

static const unsigned char content[ORL_COMPILED_DIGEST] = {1, 2, 3};

static void path_of(int fd, char path[64])
{
    snprintf(path, 64, "/proc/self/fd/%d", fd);
}

/* Returns the file of a tree of two levels, built on the first call. */
static size_t sound_file(const unsigned char **ret_bytes)
{
    static unsigned char *bytes;
    static size_t size;
    if (!bytes) {
        struct text xml = make_tree_file(2);
        struct orl_bsdf *bsdf = NULL;
        uint64_t written = 0;
        char path[64];
        const int fd = memfd_create("sound", MFD_CLOEXEC);
        path_of(fd, path);
        FUZZ_PROMISE(orl_bsdf_load_xml("x.xml", xml.data, xml.size, &bsdf, NULL) == 0);
        FUZZ_PROMISE(orl_bsdf_write(bsdf, content, path, &written, NULL) == 0);
        FUZZ_PROMISE(written > 0 && written < MOST);
        size = (size_t)written;
        bytes = malloc(size);
        FUZZ_PROMISE(bytes && pread(fd, bytes, size, 0) == (ssize_t)size);
        orl_bsdf_unref(bsdf);
        free(xml.data);
        close(fd);
    }
    *ret_bytes = bytes;
    return size;
}

static size_t edit(unsigned char *bytes, size_t size, const uint8_t *how)
{
    const size_t at = (8 * ((size_t)how[0] | (size_t)how[1] << 8)) % (size ? size : 1);
    switch (how[2] % 4) {
    case 0:
        bytes[at] = how[3];
        return size;
    case 1:
        bytes[at] ^= (unsigned char)(1 << how[3] % 8);
        return size;
    case 2:
        memset(bytes + at, how[3], size - at < 8 ? size - at : 8);
        return size;
    default:
        return at;
    }
}

static void check_bsdf(const struct orl_bsdf *bsdf)
{
    static const struct orl_vec3 ways[] = {{0, 0, 1}, {0.6, 0, -0.8}, {0, -0.8, 0.6}};
    for (int i = 0; i < 9; i++) {
        const struct orl_rgb f = orl_bsdf_eval(bsdf, ways[i / 3], ways[i % 3]);
        FUZZ_PROMISE(isfinite(f.r) && f.r >= 0 && isfinite(f.g) && isfinite(f.b));
    }
}

bool fuzz_compiled(const uint8_t *data, size_t size)
{
    const unsigned char *sound;
    const size_t whole = sound_file(&sound);
    size_t left = whole;
    struct orl_bsdf *bsdf = NULL;
    struct orl_error err = {0};
    char path[64];
    unsigned char *bytes = malloc(whole);
    FUZZ_PROMISE(bytes != NULL);
    memcpy(bytes, sound, whole);
    for (size_t i = 0; i + EDIT <= size && left > 0; i += EDIT)
        left = edit(bytes, left, data + i);
    const bool same = left == whole && memcmp(bytes, sound, whole) == 0;
    const int fd = memfd_create("compiled", MFD_CLOEXEC);
    FUZZ_PROMISE(fd >= 0 && write(fd, bytes, left) == (ssize_t)left);
    path_of(fd, path);
    const int code = orl_bsdf_open(path, content, &bsdf, &err);
    FUZZ_PROMISE(!same || code == 0);
    if (code < 0)
        fuzz_check_error(code, &err);
    else
        check_bsdf(bsdf);
    orl_bsdf_unref(bsdf);
    close(fd);
    free(bytes);
    return code == 0;
}
