#include "guide/markdown.h"

#include <ctype.h>
#include <md4c-html.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ANCHOR = 120 };

/* A page while it is rendered. */
struct page_writer {
    const char *name;
    FILE *html;    /* the page so far */
    FILE *text;    /* plain text of the last section */
    char *text_at; /* the memory of text */
    size_t text_size;
    struct orl_guide_text *page;
    int in_heading; /* level of the heading that is being written; 0: none */
    bool no_memory;
};

/* ---- Plain text ---- */

static const struct {
    const char *entity;
    char character;
} entities[] = {{"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}};

/* Writes the plain text of escaped HTML without tags. */
static void write_unescaped(FILE *out, const char *html, size_t size)
{
    for (size_t i = 0; i < size;) {
        size_t step = 1;
        char character = html[i];
        for (size_t k = 0; character == '&' && k < sizeof entities / sizeof *entities; k++) {
            const size_t length = strlen(entities[k].entity);
            if (length <= size - i && strncmp(html + i, entities[k].entity, length) == 0) {
                character = entities[k].character;
                step = length;
                break;
            }
        }
        fputc(character, out);
        i += step;
    }
}

/* Returns the plain text of HTML up to `end`, owned by the caller, or NULL. */
static char *plain_text(const char *html, const char *end)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    while (html < end) {
        const size_t run = strcspn(html, "<");
        const size_t length = run < (size_t)(end - html) ? run : (size_t)(end - html);
        write_unescaped(out, html, length);
        html += length;
        const char *close = html < end ? strchr(html, '>') : NULL;
        html = close ? close + 1 : end;
    }
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}

/* ---- Sections and their anchors ---- */

static bool is_anchor_taken(const struct orl_guide_text *page, const char *anchor)
{
    for (size_t i = 0; i < page->count; i++)
        if (strcmp(page->sections[i].anchor, anchor) == 0)
            return true;
    return false;
}

/* The anchor of a heading, as GitHub makes it: small letters, digits, '-' and '_'; blanks become
 * '-', other ASCII characters are left out. A second one of that name ends in "-1". */
static void make_anchor(const struct orl_guide_text *page, const char *heading,
                        char ret_anchor[ANCHOR])
{
    char base[ANCHOR - 8];
    size_t used = 0;
    for (const char *c = heading; *c && used < sizeof base - 1; c++) {
        const unsigned char code = (unsigned char)*c;
        if (isalnum(code) || code >= 0x80 || code == '-' || code == '_')
            base[used++] = (char)tolower(code);
        else if (code == ' ')
            base[used++] = '-';
    }
    base[used] = '\0';
    snprintf(ret_anchor, ANCHOR, "%s", base);
    for (int i = 1; is_anchor_taken(page, ret_anchor) && i < 1000; i++)
        snprintf(ret_anchor, ANCHOR, "%s-%d", base, i);
}

/* Ends the plain text of the last section. */
static void end_section(struct page_writer *writer)
{
    if (!writer->text)
        return;
    if (fclose(writer->text) != 0) {
        free(writer->text_at);
        writer->no_memory = true;
    } else
        writer->page->sections[writer->page->count - 1].text = writer->text_at;
    writer->text = NULL;
}

/* Begins a section. Takes ownership of heading, which may be NULL after a lack of memory. */
static const struct orl_guide_section *begin_section(struct page_writer *writer, int level,
                                                     const char *anchor, char *heading)
{
    struct orl_guide_text *page = writer->page;
    end_section(writer);
    struct orl_guide_section *sections =
        realloc(page->sections, (page->count + 1) * sizeof *sections);
    char *anchor_copy = strdup(anchor);
    if (sections)
        page->sections = sections;
    writer->text = sections && anchor_copy && heading
                       ? open_memstream(&writer->text_at, &writer->text_size)
                       : NULL;
    if (!writer->text) {
        free(anchor_copy);
        free(heading);
        writer->no_memory = true;
        return NULL;
    }
    sections[page->count] =
        (struct orl_guide_section){.level = level, .anchor = anchor_copy, .heading = heading};
    return &sections[page->count++];
}

/* ---- Tags ---- */

static bool is_tag(const char *tag, const char *name)
{
    const size_t length = strlen(name);
    return strncmp(tag, name, length) == 0 && !isalnum((unsigned char)tag[length]);
}

/* Writes the opening tag of a heading. The first one of level 1 is the page's title. */
static void open_heading(struct page_writer *writer, const char *tag, int level)
{
    const char closing[] = {'<', '/', 'h', (char)('0' + level), '>', '\0'};
    const char *from = strchr(tag, '>') + 1, *end = strstr(from, closing);
    char anchor[ANCHOR] = "", *heading = plain_text(from, end ? end : from);
    const bool is_title = level == 1 && writer->page->count == 1;
    writer->in_heading = level;
    if (is_title && heading && writer->page->sections[0].heading[0] == '\0') {
        free(writer->page->sections[0].heading);
        writer->page->sections[0].heading = heading;
        fputs("<h1>", writer->html);
        return;
    }
    if (heading)
        make_anchor(writer->page, heading, anchor);
    begin_section(writer, level, anchor, heading);
    fprintf(writer->html, "<h%d id=\"%s\">", level, anchor);
}

static void close_heading(struct page_writer *writer)
{
    const struct orl_guide_text *page = writer->page;
    const struct orl_guide_section *section = page->count ? &page->sections[page->count - 1] : NULL;
    if (section && section->anchor[0])
        fprintf(writer->html, "<a class=\"anchor\" href=\"#%s\" aria-label=\"Link to here\"></a>",
                section->anchor);
    fprintf(writer->html, "</h%d>", writer->in_heading);
    writer->in_heading = 0;
}

/* Writes a tag with the address of its link or picture resolved. attribute: " href=\"". */
static void write_with_address(struct page_writer *writer, const char *tag, const char *end,
                               const char *attribute)
{
    char link[ORL_GUIDE_URL], url[ORL_GUIDE_URL];
    const char *at = strstr(tag, attribute), *value = at ? at + strlen(attribute) : NULL;
    const size_t length = value ? strcspn(value, "\"") : 0;
    if (!value || value > end || length >= sizeof link) {
        fwrite(tag, 1, (size_t)(end - tag), writer->html);
        return;
    }
    memcpy(link, value, length);
    link[length] = '\0';
    const char *resolved = orl_guide_resolve(writer->name, link, url);
    fwrite(tag, 1, (size_t)(at - tag), writer->html);
    if (*resolved)
        fprintf(writer->html, "%s%s\"", attribute, resolved);
    fwrite(value + length + 1, 1, (size_t)(end - value) - length - 1, writer->html);
}

/* Writes a tag other than a heading's, from '<' to before `end`. */
static void write_tag(struct page_writer *writer, const char *tag, const char *end)
{
    static const char *const inlines[] = {"a",  "/a",  "code",   "/code",
                                          "em", "/em", "strong", "/strong"};
    const char *name = tag + 1;
    bool separates = true;
    for (size_t i = 0; i < sizeof inlines / sizeof *inlines; i++)
        separates = separates && !is_tag(name, inlines[i]);
    if (separates && writer->text)
        fputc(' ', writer->text);
    if (is_tag(name, "a"))
        write_with_address(writer, tag, end, " href=\"");
    else if (is_tag(name, "img"))
        write_with_address(writer, tag, end, " src=\"");
    else if (is_tag(name, "table")) /* wide tables scroll, by the keyboard too */
        fputs("<div class=\"scroll\" role=\"region\" tabindex=\"0\" aria-label=\"Table\"><table>",
              writer->html);
    else if (is_tag(name, "/table"))
        fputs("</table></div>", writer->html);
    else if (is_tag(name, "pre"))
        fputs("<pre tabindex=\"0\">", writer->html);
    else
        fwrite(tag, 1, (size_t)(end - tag), writer->html);
}

/* Copies one tag, comment or run of text. Returns what follows. */
static const char *copy_item(struct page_writer *writer, const char *at)
{
    if (*at != '<') {
        const size_t length = strcspn(at, "<");
        fwrite(at, 1, length, writer->html);
        if (writer->text && !writer->in_heading)
            write_unescaped(writer->text, at, length);
        return at + length;
    }
    if (strncmp(at, "<!--", 4) == 0) {
        const char *end = strstr(at, "-->");
        return end ? end + 3 : at + strlen(at);
    }
    const char *end = strchr(at, '>');
    end = end ? end + 1 : at + strlen(at);
    if (at[1] == 'h' && at[2] >= '1' && at[2] <= '6' && at[3] == '>')
        open_heading(writer, at, at[2] - '0');
    else if (at[1] == '/' && at[2] == 'h' && at[3] >= '1' && at[3] <= '6' && writer->in_heading)
        close_heading(writer);
    else
        write_tag(writer, at, end);
    return end;
}

/* ---- The page ---- */

static void append_output(const MD_CHAR *data, MD_SIZE size, void *out)
{
    fwrite(data, 1, size, out);
}

/* Returns md4c's HTML, owned by the caller, or NULL. */
static char *html_of_markdown(const char *markdown, size_t size)
{
    char *html = NULL;
    size_t html_size = 0;
    FILE *out = open_memstream(&html, &html_size);
    if (!out)
        return NULL;
    const int rc = md_html(markdown, (MD_SIZE)size, append_output, out,
                           MD_FLAG_TABLES | MD_FLAG_STRIKETHROUGH | MD_FLAG_TASKLISTS |
                               MD_FLAG_PERMISSIVEURLAUTOLINKS | MD_FLAG_NOHTMLSPANS,
                           MD_HTML_FLAG_SKIP_UTF8_BOM);
    if (fclose(out) != 0 || rc != 0) {
        free(html);
        return NULL;
    }
    return html;
}

int orl_guide_render(const char *name, const char *markdown, size_t size,
                     struct orl_guide_text *ret_text, struct orl_error *err)
{
    struct orl_guide_text page = {0};
    char *page_html = NULL, *html = html_of_markdown(markdown, size);
    size_t page_size = 0;
    struct page_writer writer = {.name = name, .page = &page};
    writer.html = html ? open_memstream(&page_html, &page_size) : NULL;
    if (writer.html)
        begin_section(&writer, 1, "", strdup(""));
    for (const char *at = html; writer.html && !writer.no_memory && *at;)
        at = copy_item(&writer, at);
    end_section(&writer);
    const bool failed = !writer.html || fclose(writer.html) != 0 || writer.no_memory;
    free(html);
    page.html = page_html;
    if (failed) {
        orl_guide_text_done(&page);
        return orl_error_no_memory(err);
    }
    *ret_text = page;
    return 0;
}

void orl_guide_text_done(struct orl_guide_text *text)
{
    for (size_t i = 0; i < text->count; i++) {
        free(text->sections[i].anchor);
        free(text->sections[i].heading);
        free(text->sections[i].text);
    }
    free(text->sections);
    free(text->html);
    *text = (struct orl_guide_text){0};
}
