/* Zips built by hand, so that they can hold what no program would write. */
#ifndef ORL_TESTS_SUPPORT_ZIP_H
#define ORL_TESTS_SUPPORT_ZIP_H

#include <stddef.h>
#include <stdint.h>

struct zip_entry {
    const char *name, *data; /* data: stored as given */
    size_t size;
    uint16_t mode;   /* Unix mode: 0120777 is a link; 0: a plain file */
    uint16_t flags;  /* 1: encrypted */
    uint16_t method; /* declared method; 0: stored */
    uint32_t damage; /* error added to the checksum */
};
#define ZIP_TEXT(entry_name, text)                                                                 \
    {                                                                                              \
        .name = (entry_name), .data = (text), .size = sizeof(text) - 1                             \
    }

/* Returns the archive, owned; fails the running test when out of memory. */
char *zip_make(const struct zip_entry *entries, size_t count, size_t *ret_size);
/* Returns an archive of one deflated file of that many zero bytes. */
char *zip_make_bomb(const char *name, size_t zeros, size_t *ret_size);

#endif
