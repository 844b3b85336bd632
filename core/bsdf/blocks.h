/*
 * Blocks of tensor-tree data put off while the XML is read, then read by a crew side by side. The
 * data are nearly all of a file, and plain text up to the block's end tag, so that it is enough to
 * remember where they stand.
 */
#ifndef ORL_BSDF_BLOCKS_H
#define ORL_BSDF_BLOCKS_H

#include <oriel/bsdf.h>

#include "bsdf/document.h"
#include "bsdf/text.h"

enum { ORL_BLOCKS_MAX = 3 * ORL_PART_COUNT }; /* a part has three channels at most */

struct orl_block {
    struct orl_tree_text text; /* as far as it was read before */
    size_t begin, end;         /* of what is put off, in the XML */
    size_t line;               /* of the begin, lines in blocks before it not counted */
    int part;                  /* an enum orl_bsdf_part, for messages */
    bool ended;                /* by its end tag: the tree must be whole */
    int code;
    struct orl_error err;
};

struct orl_blocks {
    const struct orl_bsdf_xml *xml; /* borrowed */
    size_t count;
    struct orl_block blocks[ORL_BLOCKS_MAX]; /* in the file's order */
};

/*
 * Reads one of them; all of them, by the crew of the XML. Returns 0 or a negative enum orl_err of
 * the first that failed, its place noted.
 */
int orl_block_read(struct orl_blocks *blocks, size_t index, struct orl_error *err);
int orl_blocks_read(struct orl_blocks *blocks, struct orl_error *err);
void orl_blocks_done(struct orl_blocks *blocks);

/* Lines that end in the first of them, so many. */
size_t orl_blocks_lines(const struct orl_blocks *blocks, size_t count);

/* Newlines from text up to end. */
size_t orl_count_lines(const char *text, const char *end);

/* The place of a block in messages: its element and direction. */
void orl_block_name(int part, char *ret_name, size_t size);

#endif
