#include "handlers/service/guide_page.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "process/embedded_files.h"

/* A document while it is written. */
struct document {
    FILE *out;
    char *text;
    size_t size;
};

/* ---- Text ---- */

/* Writes text with the characters of HTML escaped, and without control characters. */
static void write_escaped(FILE *out, const char *text, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        const unsigned char c = (unsigned char)text[i];
        if (c == '&')
            fputs("&amp;", out);
        else if (c == '<')
            fputs("&lt;", out);
        else if (c == '>')
            fputs("&gt;", out);
        else if (c == '"')
            fputs("&quot;", out);
        else if (c >= ' ')
            fputc(c, out);
        else if (c == '\n' || c == '\t')
            fputc(' ', out);
    }
}

static void write_text(FILE *out, const char *text)
{
    write_escaped(out, text, strlen(text));
}

/* Writes a snippet; its found words stand between the bytes 1 and 2. */
static void write_snippet(FILE *out, const char *snippet)
{
    while (*snippet) {
        const size_t length = strcspn(snippet, "\1\2");
        write_escaped(out, snippet, length);
        snippet += length;
        if (*snippet)
            fputs(*snippet++ == '\1' ? "<mark>" : "</mark>", out);
    }
}

/* ---- The frame ---- */

static void write_address(FILE *out, const struct orl_guide_page *page)
{
    const bool is_start = strcmp(page->name, "index") == 0;
    fprintf(out, "/guide%s%s", is_start ? "" : "/", is_start ? "" : page->name);
}

static void write_head(FILE *out, const char *title, const char *question)
{
    const char *version = orl_dashboard_version();
    fputs("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
          "<meta name=\"color-scheme\" content=\"light dark\">\n<title>",
          out);
    write_text(out, title);
    fprintf(out,
            " \xe2\x80\x93 Oriel</title>\n"
            "<link rel=\"icon\" type=\"image/svg+xml\" href=\"/dashboard/%s/icon.svg\">\n"
            "<link rel=\"stylesheet\" href=\"/dashboard/%s/style.css\">\n"
            "<link rel=\"stylesheet\" href=\"/dashboard/%s/guide.css\">\n</head>\n<body>\n",
            version, version, version);
    fputs("<a class=\"skip\" href=\"#main\">To the content</a>\n<header class=\"top\">\n"
          "<a class=\"brand\" href=\"/\">Oriel</a>\n<nav aria-label=\"Pages\"><ul>"
          "<li><a href=\"/#/jobs\">Jobs</a></li>"
          "<li><a href=\"/guide\" aria-current=\"page\">Guide</a></li></ul></nav>\n"
          "<form class=\"top-end\" role=\"search\" action=\"/guide/search\">"
          "<label class=\"unseen\" for=\"q\">Search the guide</label>"
          "<input id=\"q\" name=\"q\" type=\"search\" placeholder=\"Search\" required value=\"",
          out);
    write_text(out, question);
    fprintf(
        out,
        "\" maxlength=\"%d\"><button type=\"submit\">Search</button></form>\n</header>\n"
        "<div class=\"guide\">\n<p class=\"to-contents\"><a href=\"#contents\">Contents</a></p>\n",
        ORL_GUIDE_QUESTION);
}

/* Writes the contents: all pages, by parts. current: the open page, or the number of pages. */
static void write_contents(FILE *out, const struct orl_guide *guide, size_t current)
{
    const char *part = "";
    fputs("<nav id=\"contents\" class=\"contents\" aria-label=\"Contents\"><ul>\n", out);
    for (size_t i = 0; i < orl_guide_count(guide); i++) {
        const struct orl_guide_page *page = orl_guide_page_at(guide, i);
        if (strcmp(page->part, part) != 0) {
            fputs("</ul>\n<h2>", out);
            write_text(out, page->part);
            fputs("</h2>\n<ul>\n", out);
            part = page->part;
        }
        fputs("<li><a href=\"", out);
        write_address(out, page);
        fputs(i == current ? "\" aria-current=\"page\">" : "\">", out);
        write_text(out, page->title);
        fputs("</a></li>\n", out);
    }
    fputs("</ul></nav>\n", out);
}

/* Writes links to the headings of level 2, if there are several. */
static void write_headings(FILE *out, const struct orl_guide_page *page)
{
    size_t found = 0;
    for (size_t i = 0; i < page->text.count; i++)
        found += page->text.sections[i].level == 2;
    if (found < 2)
        return;
    fputs("<nav class=\"headings\" aria-labelledby=\"on-this-page\">"
          "<h2 id=\"on-this-page\">On this page</h2><ul>\n",
          out);
    for (size_t i = 0; i < page->text.count; i++) {
        if (page->text.sections[i].level != 2)
            continue;
        fprintf(out, "<li><a href=\"#%s\">", page->text.sections[i].anchor);
        write_text(out, page->text.sections[i].heading);
        fputs("</a></li>\n", out);
    }
    fputs("</ul></nav>\n", out);
}

static void write_turn(FILE *out, const struct orl_guide_page *page, const char *rel,
                       const char *words)
{
    fprintf(out, "<a rel=\"%s\" href=\"", rel);
    write_address(out, page);
    fprintf(out, "\"><span class=\"quiet\">%s</span> ", words);
    write_text(out, page->title);
    fputs("</a>\n", out);
}

/* Writes links to the pages before and behind. */
static void write_turns(FILE *out, const struct orl_guide *guide, size_t page)
{
    fputs("<nav class=\"turns\" aria-label=\"Previous and next page\">\n", out);
    if (page > 0)
        write_turn(out, orl_guide_page_at(guide, page - 1), "prev", "Previous");
    if (page + 1 < orl_guide_count(guide))
        write_turn(out, orl_guide_page_at(guide, page + 1), "next", "Next");
    fputs("</nav>\n", out);
}

static void begin_document(struct document *document, const char *title, const char *question)
{
    document->out = open_memstream(&document->text, &document->size);
    if (!document->out)
        return;
    write_head(document->out, title, question);
    fputs("<main id=\"main\" tabindex=\"-1\">\n", document->out);
}

/* Ends the document; returns its text, or NULL. */
static char *end_document(struct document *document, const struct orl_guide *guide, size_t current)
{
    if (!document->out)
        return NULL;
    fputs("</main>\n", document->out);
    if (current < orl_guide_count(guide))
        write_headings(document->out, orl_guide_page_at(guide, current));
    write_contents(document->out, guide, current);
    fputs("</div>\n</body>\n</html>\n", document->out);
    if (fclose(document->out) != 0) {
        free(document->text);
        return NULL;
    }
    return document->text;
}

/* ---- The documents ---- */

char *orl_guide_page_html(const struct orl_guide *guide, size_t index)
{
    const struct orl_guide_page *page = orl_guide_page_at(guide, index);
    struct document document;
    begin_document(&document, page->title, "");
    if (document.out) {
        if (*page->part) {
            fputs("<p class=\"crumb\">", document.out);
            write_text(document.out, page->part);
            fputs("</p>\n", document.out);
        }
        fprintf(document.out, "<article>\n%s</article>\n", page->text.html);
        write_turns(document.out, guide, index);
    }
    return end_document(&document, guide, index);
}

char *orl_guide_missing_html(const struct orl_guide *guide, const char *name)
{
    struct document document;
    begin_document(&document, "No such page", "");
    if (document.out) {
        fputs("<article><h1>No such page</h1>\n<p>The guide has no page <code>", document.out);
        write_text(document.out, name);
        fputs("</code>. It may have moved: search for it, or choose it from the contents.</p>"
              "</article>\n",
              document.out);
    }
    return end_document(&document, guide, orl_guide_count(guide));
}

static void write_hit(void *context, const struct orl_guide_hit *hit)
{
    FILE *out = context;
    fputs("<li><a href=\"", out);
    write_address(out, hit->page);
    if (hit->section->anchor[0])
        fprintf(out, "#%s", hit->section->anchor);
    fputs("\">", out);
    write_text(out, hit->page->title);
    if (hit->section->level > 1) {
        fputs(" \xe2\x80\xba ", out);
        write_text(out, hit->section->heading);
    }
    fputs("</a><p>", out);
    write_snippet(out, hit->snippet);
    fputs("</p></li>\n", out);
}

/* Says in a sentence what was found. */
static void write_summary(FILE *out, const struct orl_guide_found *found, bool failed)
{
    fputs("<p class=\"quiet\" role=\"status\">", out);
    if (failed)
        fputs("The search failed for want of memory. Try again later.", out);
    else if (found->words == 0)
        fputs("Enter one or more words, such as <a href=\"/guide/search?q=weather+file\">weather "
              "file</a>.",
              out);
    else if (found->hits == 0)
        fputs("No page has any of these words. Try fewer or other words.", out);
    else if (found->only_some)
        fputs("No section has all of these words. These have some of them.", out);
    else if (found->hits == ORL_GUIDE_HITS)
        fprintf(out, "The best %d sections, the best first.", ORL_GUIDE_HITS);
    else
        fprintf(out, "%zu section%s.", found->hits, found->hits == 1 ? "" : "s, the best first");
    if (found->shortened)
        fprintf(out, " Only the first %d words, or %d bytes, were searched.", ORL_GUIDE_WORDS,
                ORL_GUIDE_QUESTION);
    fputs("</p>\n", out);
}

char *orl_guide_search_html(struct orl_guide *guide, const char *question)
{
    struct document document;
    struct orl_guide_found found = {0};
    char *hits = NULL;
    size_t hits_size = 0;
    FILE *out = open_memstream(&hits, &hits_size);
    if (!out)
        return NULL;
    const char *words = question ? question : "";
    const bool failed = orl_guide_search(guide, words, write_hit, out, &found, NULL) != 0;
    if (fclose(out) != 0) {
        free(hits);
        return NULL;
    }
    begin_document(&document, "Search", words);
    if (document.out) {
        fputs("<article><h1>Search</h1>\n", document.out);
        write_summary(document.out, &found, failed);
        fprintf(document.out, "<ol class=\"hits\">\n%s</ol></article>\n", failed ? "" : hits);
    }
    free(hits);
    return end_document(&document, guide, orl_guide_count(guide));
}
