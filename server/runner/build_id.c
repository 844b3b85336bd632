#include "runner/checkpoints.h"

#include <elf.h>
#include <link.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include <oriel/base/sha256.h>
#include <oriel/base/version.h>

static const char *aligned(const char *at, size_t to, const char *from)
{
    return from + ((size_t)(at - from) + to - 1) / to * to;
}

/* Returns the build ID among `bytes` bytes of notes in memory (elf(5)); NULL: none. */
static const unsigned char *find_build_id(const char *notes, size_t bytes, size_t align,
                                          size_t *ret_size)
{
    const size_t step = align == 8 ? 8 : 4;
    const char *at = notes, *const end = notes + bytes;
    ElfW(Nhdr) note;
    while ((size_t)(end - at) >= sizeof note) {
        memcpy(&note, at, sizeof note);
        const char *name = at + sizeof note;
        if (note.n_namesz > (size_t)(end - name))
            break;
        const char *value = aligned(name + note.n_namesz, step, notes);
        if (value > end || note.n_descsz > (size_t)(end - value))
            break;
        if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && memcmp(name, "GNU", 4) == 0) {
            *ret_size = note.n_descsz;
            return (const unsigned char *)value;
        }
        at = aligned(value + note.n_descsz, step, notes);
        if (at > end)
            break;
    }
    return NULL;
}

static void add_file(struct orl_sha256 *hash, const char *name)
{
    const char *path = *name ? name : "/proc/self/exe";
    char line[80] = "";
    struct stat st;
    if (stat(path, &st) == 0)
        snprintf(line, sizeof line, " %lld %lld.%09ld", (long long)st.st_size,
                 (long long)st.st_mtim.tv_sec, st.st_mtim.tv_nsec);
    orl_sha256_add(hash, name, strlen(name));
    orl_sha256_add(hash, line, strlen(line) + 1);
}

static int add_object(struct dl_phdr_info *info, size_t size, void *hash)
{
    const char *name = info->dlpi_name ? info->dlpi_name : "";
    (void)size;
    if (*name && !strchr(name, '/'))
        return 0; /* the kernel's vDSO, which is not a file */
    for (int i = 0; i < info->dlpi_phnum; i++) {
        const ElfW(Phdr) *part = &info->dlpi_phdr[i];
        size_t length = 0;
        if (part->p_type != PT_NOTE)
            continue;
        const unsigned char *id = find_build_id((const char *)(info->dlpi_addr + part->p_vaddr),
                                                part->p_memsz, part->p_align, &length);
        if (id) {
            orl_sha256_add(hash, id, length);
            return 0;
        }
    }
    add_file(hash, name);
    return 0;
}

void orl_program_digest(char ret_digest[ORL_SHA_HEX])
{
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, ORL_VERSION, sizeof ORL_VERSION);
    dl_iterate_phdr(add_object, &hash);
    orl_sha256_finish_hex(&hash, ret_digest);
}
