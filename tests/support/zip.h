/* Zips put together by hand, so that they may hold what no program would write. */
#ifndef ORL_TESTS_SUPPORT_ZIP_H
#define ORL_TESTS_SUPPORT_ZIP_H

#include <stddef.h>
#include <stdint.h>

struct zip_entry {
    const char *name, *data; /* stored as it is */
    size_t size;
    uint16_t mode;   /* Unix: 0120777 is a link; 0: a plain file */
    uint16_t flags;  /* 1: encrypted */
    uint16_t method; /* as it is said to be; 0: stored */
    uint32_t damage; /* of the checksum */
};
#define ZIP_TEXT(entry_name, text)                                                                 \
    {                                                                                              \
        .name = (entry_name), .data = (text), .size = sizeof(text) - 1                             \
    }

/* The archive, owned; fails the running test when out of memory. */
char *zip_make(const struct zip_entry *entries, size_t count, size_t *ret_size);
/* One file of so many zero bytes, deflated. */
char *zip_make_bomb(const char *name, size_t zeros, size_t *ret_size);

#endif
