#include "bsdf/xml/xml_tree_blocks.h"

#include <oriel/base/thread_pool.h>
#include <stdio.h>

enum { SLICE = 1 << 20 }; /* bytes read between two checks of the cancel flag */

size_t orl_count_lines(const char *text, const char *end)
{
    size_t lines = 0;
    for (; text < end; text++)
        lines += *text == '\n';
    return lines;
}

size_t orl_blocks_lines(const struct orl_blocks *blocks, size_t count)
{
    const char *const data = blocks->xml->data;
    size_t lines = 0;
    for (size_t i = 0; i < count; i++)
        lines += orl_count_lines(data + blocks->blocks[i].begin, data + blocks->blocks[i].end);
    return lines;
}

void orl_block_name(int part, char *ret_name, size_t size)
{
    snprintf(ret_name, size, "WavelengthDataBlock %s", orl_component_names[part]);
}

/* Parses a block's text in slices, and reports each slice to the XML's `passed` callback. */
static int feed_block(const struct orl_bsdf_xml *xml, struct orl_block *block,
                      struct orl_error *err)
{
    int code = 0;
    for (size_t at = block->begin; at < block->end && code == 0;) {
        const size_t size = block->end - at < SLICE ? block->end - at : SLICE;
        if (orl_is_cancelled(xml->cancel))
            return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while reading the BSDF");
        code = orl_tree_text_feed(&block->text, xml->data + at, size, err);
        if (xml->passed)
            xml->passed(xml->ctx, at, at + size);
        at += size;
    }
    return code;
}

int orl_block_read(struct orl_blocks *blocks, size_t index, struct orl_error *err)
{
    const struct orl_bsdf_xml *xml = blocks->xml;
    struct orl_block *block = &blocks->blocks[index];
    const char *failed_at = xml->data + block->end;
    int code = feed_block(xml, block, err);
    if (code == ORL_ERR_CANCELLED)
        return code; /* not an error of the file; perhaps no text of the block was read */
    if (code < 0)
        failed_at = block->text.scan.next;
    else if (block->ended)
        code = orl_tree_text_finish(&block->text, err);
    if (code < 0) {
        const size_t line = block->line + orl_blocks_lines(blocks, index) +
                            orl_count_lines(xml->data + block->begin, failed_at);
        char place[ORL_ERROR_NAME_MAX];
        orl_block_name(block->part, place, sizeof place);
        orl_error_at(err, xml->name, (int)line, place);
    }
    return code;
}

static void read_one(void *arg, size_t index, uint32_t member)
{
    struct orl_blocks *blocks = arg;
    struct orl_block *block = &blocks->blocks[index];
    (void)member;
    block->code = orl_block_read(blocks, index, &block->err);
}

int orl_blocks_read(struct orl_blocks *blocks, struct orl_error *err)
{
    orl_parallel_for(blocks->xml->pool, blocks->count, read_one, blocks);
    for (size_t i = 0; i < blocks->count; i++)
        if (blocks->blocks[i].code < 0) {
            if (err)
                *err = blocks->blocks[i].err;
            return blocks->blocks[i].code;
        }
    return 0;
}

void orl_blocks_done(struct orl_blocks *blocks)
{
    for (size_t i = 0; i < blocks->count; i++)
        orl_tree_text_done(&blocks->blocks[i].text);
    blocks->count = 0;
}
