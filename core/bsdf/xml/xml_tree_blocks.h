/*
 * Blocks of tensor-tree data that are skipped while the XML is parsed and then read in parallel by
 * a crew. Most of a file is such data. It is plain text up to the block's end tag, so its position
 * is enough to find it again.
 */
#ifndef ORL_BSDF_XML_XML_TREE_BLOCKS_H
#define ORL_BSDF_XML_XML_TREE_BLOCKS_H

#include <oriel/bsdf/bsdf.h>

#include "bsdf/document.h"
#include "bsdf/xml/data_text.h"

enum { ORL_BLOCKS_MAX = 3 * ORL_COMPONENT_COUNT }; /* a part has at most three channels */

struct orl_block {
    struct orl_tree_text text; /* parser state after the text that was read before */
    size_t begin, end;         /* range of the deferred text, bytes of the XML */
    size_t line;               /* line number at begin, without the lines inside earlier blocks */
    int part;                  /* an enum orl_component_kind, for messages */
    bool ended;                /* true if the block's end tag was seen: the tree must be complete */
    int code;
    struct orl_error err;
};

struct orl_blocks {
    const struct orl_bsdf_xml *xml; /* borrowed */
    size_t count;
    struct orl_block blocks[ORL_BLOCKS_MAX]; /* in the file's order */
};

/*
 * orl_block_read reads one block; orl_blocks_read reads all with the crew of the XML. Both return 0
 * or a negative enum orl_err, that of the first block that failed, with line and element set.
 */
int orl_block_read(struct orl_blocks *blocks, size_t index, struct orl_error *err);
int orl_blocks_read(struct orl_blocks *blocks, struct orl_error *err);
void orl_blocks_done(struct orl_blocks *blocks);

/* Returns the number of newlines in the first `count` blocks. */
size_t orl_blocks_lines(const struct orl_blocks *blocks, size_t count);

/* Returns the number of newlines from text up to end. */
size_t orl_count_lines(const char *text, const char *end);

/* Writes the name of a block for messages: its element and direction. */
void orl_block_name(int part, char *ret_name, size_t size);

#endif
