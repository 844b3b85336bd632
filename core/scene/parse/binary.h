/*
 * What oconv and obj2mesh write: a header of text, then integers (big-endian, signed), numbers
 * (four bytes of mantissa, one of exponent) and strings that end in NUL, read from front to back.
 * Reference: "Radiance File Formats" (Ward, 2019), octrees and compiled meshes.
 *
 * A read behind the end gives zeros and sets ended; whoever reads looks at that before it counts on
 * anything. Nothing is copied: strings point into the data.
 */
#ifndef ORL_SCENE_PARSE_BINARY_H
#define ORL_SCENE_PARSE_BINARY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

struct orl_binary {
    const unsigned char *data;
    size_t size, at;
    bool ended; /* something behind the end was asked for */
};

/* Passes over the header; ORL_ERR_SYNTAX unless it says that format. */
int orl_binary_open(const char *data, size_t size, const char *format, struct orl_binary *ret,
                    struct orl_error *err);

/* bytes: 1 to 8. */
int64_t orl_binary_int(struct orl_binary *binary, unsigned bytes);
double orl_binary_number(struct orl_binary *binary);
/* "" behind the end, or where one is longer than Radiance's may be. */
const char *orl_binary_string(struct orl_binary *binary);
void orl_binary_skip(struct orl_binary *binary, uint64_t bytes);

/* Passes over an octree whose leaves are sets of integers of so many bytes. */
int orl_binary_skip_octree(struct orl_binary *binary, unsigned bytes, struct orl_error *err);

/* "it ends too early", or what else says that it is no such file. Returns ORL_ERR_SYNTAX. */
int orl_binary_fail(const struct orl_binary *binary, const char *what, struct orl_error *err);

/* Of primitives, in order; they lie in the data. The array is the caller's to free. */
struct orl_binary_names {
    const char **at;
    size_t count, room;
};

/*
 * Primitives, as scene text: take is called with pieces of it, each of whole primitives, in order.
 * They refer to each other by number; here by name, which means the same unless one is defined
 * twice. names is filled as they come. ORL_ERR_SYNTAX, _NOMEM, or what take returns.
 */
int orl_binary_primitives(struct orl_binary *binary, unsigned bytes, struct orl_binary_names *names,
                          int (*take)(void *ctx, const char *text, size_t size,
                                      struct orl_error *err),
                          void *ctx, struct orl_error *err);

#endif
