#include "run/cache/word_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/files.h>

#include "base/io/checked_file.h"

struct header {
    char magic[8]; /* "ORIELKP" and NUL */
    uint32_t version, byte_order;
    char key[ORL_DIGEST_HEX], family[ORL_DIGEST_HEX];
    uint64_t target, rays;
    uint64_t words, coded;                      /* number of words, decoded and encoded */
    unsigned char checksum[ORL_CHECKSUM_BYTES]; /* checksum of all after the header */
    unsigned char of_header[ORL_CHECKSUM_BYTES];
};
_Static_assert(sizeof(struct header) == 208, "without holes");

enum { VERSION = 1, BYTE_ORDER_MARK = 0x01020304, LEAST_ZEROS = 4 };

/* ---- Runs ------------------------------------------------------------------------------------ */

static size_t count_zeros(const uint32_t *words, size_t at, size_t n)
{
    const size_t from = at;
    while (at < n && words[at] == 0 && at - from < UINT32_MAX)
        at++;
    return at - from;
}

/* Returns the number of words before the next zeros that are worth a run. */
static size_t count_others(const uint32_t *words, size_t at, size_t n)
{
    const size_t from = at;
    while (at < n && at - from < UINT32_MAX / 2) {
        const size_t zeros = words[at] == 0 ? count_zeros(words, at, n) : 0;
        if (zeros >= LEAST_ZEROS || at + zeros == n)
            break;
        at += zeros > 0 ? zeros : 1;
    }
    return at - from;
}

/* Encodes the words; returns their encoded number. ret_coded: NULL only counts. */
static size_t encode(const uint32_t *words, size_t n, uint32_t *ret_coded)
{
    size_t used = 0;
    for (size_t at = 0; at < n;) {
        const size_t zeros = count_zeros(words, at, n);
        const size_t others = count_others(words, at + zeros, n);
        if (ret_coded) {
            ret_coded[used] = (uint32_t)zeros;
            ret_coded[used + 1] = (uint32_t)others;
            memcpy(ret_coded + used + 2, words + at + zeros, others * sizeof *words);
        }
        used += 2 + others;
        at += zeros + others;
    }
    return used;
}

static bool decode(const uint32_t *coded, size_t n_coded, uint32_t *ret_words, size_t n)
{
    size_t at = 0, i = 0;
    while (i + 2 <= n_coded) {
        const size_t zeros = coded[i], others = coded[i + 1];
        i += 2;
        if (zeros > n - at || others > n - at - zeros || others > n_coded - i)
            return false;
        memset(ret_words + at, 0, zeros * sizeof *ret_words);
        memcpy(ret_words + at + zeros, coded + i, others * sizeof *ret_words);
        at += zeros + others;
        i += others;
    }
    return at == n && i == n_coded;
}

/* ---- Writing --------------------------------------------------------------------------------- */

static int write_file(const char *path, const struct header *h, const uint32_t *coded,
                      struct orl_error *err)
{
    FILE *file = orl_fopen_regular(path, 'w');
    bool fine = file && fwrite(h, sizeof *h, 1, file) == 1 &&
                fwrite(coded, sizeof *coded, h->coded, file) == h->coded;
    if (file && fclose(file) != 0)
        fine = false;
    if (fine)
        return 0;
    const int why = errno;
    if (file)
        unlink(path);
    return orl_error_set(err, orl_err_of_errno(why), "cannot write '%s': %s", path,
                         orl_open_reason(why));
}

int orl_word_file_write(const char *path, struct orl_word_file_info *file_info, const void *data,
                        size_t size, struct orl_error *err)
{
    const size_t words = size / sizeof(uint32_t), n = encode(data, words, NULL);
    struct header h = {.magic = "ORIELKP",
                       .version = VERSION,
                       .byte_order = BYTE_ORDER_MARK,
                       .target = file_info->target,
                       .rays = file_info->rays,
                       .words = words,
                       .coded = n};
    uint32_t *coded = malloc(n * sizeof *coded + 1);
    if (!coded)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    encode(data, words, coded);
    memcpy(h.key, file_info->key, sizeof h.key);
    memcpy(h.family, file_info->family, sizeof h.family);
    orl_checksum_of(coded, n * sizeof *coded, h.checksum);
    orl_checksum_of(&h, offsetof(struct header, of_header), h.of_header);
    file_info->bytes = sizeof h + n * sizeof *coded;
    const int code = write_file(path, &h, coded, err);
    free(coded);
    return code;
}

/* ---- Reading --------------------------------------------------------------------------------- */

static int report_damage(const char *path, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_CORRUPT, "'%s' is truncated, damaged or not a cache file", path);
    return ORL_ERR_CORRUPT;
}

static int check_header(const char *path, const struct header *h, uint64_t bytes,
                        struct orl_error *err)
{
    unsigned char sum[ORL_CHECKSUM_BYTES];
    if (memcmp(h->magic, "ORIELKP", sizeof h->magic) != 0)
        return report_damage(path, err);
    if (h->version != VERSION || h->byte_order != BYTE_ORDER_MARK) {
        orl_error_set(err, ORL_ERR_VERSION, "'%s' has another version", path);
        return ORL_ERR_VERSION;
    }
    orl_checksum_of(h, offsetof(struct header, of_header), sum);
    if (memcmp(sum, h->of_header, sizeof sum) != 0 ||
        h->coded > (bytes - sizeof *h) / sizeof(uint32_t) ||
        bytes != sizeof *h + h->coded * sizeof(uint32_t) || h->words > SIZE_MAX / sizeof(uint32_t))
        return report_damage(path, err);
    return 0;
}

/* Opens a file and checks its header. The caller closes *ret_file on success. */
static int open_file(const char *path, struct header *h, struct orl_word_file_info *ret_file_info,
                     FILE **ret_file, struct orl_error *err)
{
    struct stat st;
    FILE *file = orl_fopen_regular(path, 'r');
    if (!file) {
        if (errno == ORL_OPEN_NOT_REGULAR)
            return report_damage(path, err);
        orl_error_set(err, ORL_ERR_IO, "cannot open '%s': %s", path, strerror(errno));
        return ORL_ERR_IO;
    }
    int code = 0;
    if (fstat(fileno(file), &st) != 0 || fread(h, sizeof *h, 1, file) != 1)
        code = report_damage(path, err);
    if (code == 0)
        code = check_header(path, h, (uint64_t)st.st_size, err);
    if (code < 0) {
        fclose(file);
        return code;
    }
    *ret_file_info = (struct orl_word_file_info){
        .target = h->target, .rays = h->rays, .bytes = (uint64_t)st.st_size};
    memcpy(ret_file_info->key, h->key, sizeof h->key);
    memcpy(ret_file_info->family, h->family, sizeof h->family);
    *ret_file = file;
    return 0;
}

int orl_word_file_describe(const char *path, struct orl_word_file_info *ret_file_info,
                           struct orl_error *err)
{
    struct header h;
    FILE *file;
    const int code = open_file(path, &h, ret_file_info, &file, err);
    if (code == 0)
        fclose(file);
    return code;
}

static int read_coded(const char *path, FILE *file, const struct header *h, uint32_t *coded,
                      struct orl_error *err)
{
    unsigned char sum[ORL_CHECKSUM_BYTES];
    if (fread(coded, sizeof *coded, h->coded, file) != h->coded)
        return report_damage(path, err);
    orl_checksum_of(coded, h->coded * sizeof *coded, sum);
    return memcmp(sum, h->checksum, sizeof sum) == 0 ? 0 : report_damage(path, err);
}

static int read_words(const char *path, FILE *file, const struct header *h, void **ret_data,
                      size_t *ret_size, struct orl_error *err)
{
    uint32_t *coded = malloc(h->coded * sizeof *coded + 1);
    uint32_t *words = ret_data ? malloc(h->words * sizeof *words + 1) : NULL;
    int code = 0;
    if (!coded || (ret_data && !words))
        orl_error_set(err, code = ORL_ERR_NOMEM, "out of memory");
    if (code == 0)
        code = read_coded(path, file, h, coded, err);
    if (code == 0 && words && !decode(coded, h->coded, words, h->words))
        code = report_damage(path, err);
    free(coded);
    if (code < 0 || !ret_data) {
        free(words);
        return code;
    }
    *ret_data = words;
    *ret_size = h->words * sizeof *words;
    return 0;
}

int orl_word_file_read(const char *path, const char *key, struct orl_word_file_info *ret_file_info,
                       void **ret_data, size_t *ret_size, struct orl_error *err)
{
    struct header h;
    FILE *file;
    int code = open_file(path, &h, ret_file_info, &file, err);
    if (code < 0)
        return code;
    code = key && strcmp(key, ret_file_info->key) != 0
               ? report_damage(path, err)
               : read_words(path, file, &h, ret_data, ret_size, err);
    fclose(file);
    return code;
}
