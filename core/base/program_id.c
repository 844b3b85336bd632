#include "base/program_id.h"

#include <link.h>
#include <string.h>

/* State of the search through the notes of the main program, which is the first object. */
struct search {
    struct orl_sha256 *hash;
    bool found;
};

static size_t align_to_4(size_t size)
{
    return (size + 3) / 4 * 4;
}

static void find_build_id(struct search *search, const char *at, size_t size)
{
    static const char owner[] = "GNU";
    ElfW(Nhdr) note;
    while (!search->found && size >= sizeof note) {
        memcpy(&note, at, sizeof note);
        const size_t name = align_to_4(note.n_namesz),
                     all = sizeof note + name + align_to_4(note.n_descsz);
        if (all > size)
            return;
        if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == sizeof owner &&
            memcmp(at + sizeof note, owner, sizeof owner) == 0) {
            orl_sha256_add(search->hash, at + sizeof note + name, note.n_descsz);
            search->found = true;
        }
        at += all;
        size -= all;
    }
}

static int visit_object(struct dl_phdr_info *info, size_t size, void *ctx)
{
    (void)size;
    for (int i = 0; i < info->dlpi_phnum; i++)
        if (info->dlpi_phdr[i].p_type == PT_NOTE)
            find_build_id(ctx, (const char *)(info->dlpi_addr + info->dlpi_phdr[i].p_vaddr),
                          info->dlpi_phdr[i].p_memsz);
    return 1; /* stop after the first object */
}

bool orl_program_id_add(struct orl_sha256 *hash)
{
    struct search search = {hash, false};
    dl_iterate_phdr(visit_object, &search);
    return search.found;
}
