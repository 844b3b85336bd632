#include "guide/guide.h"

#include <ctype.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "guide/guide_private.h"

/* Folders of the guide, in the order of its parts. Pages outside folders are the last part. */
static const struct {
    const char *folder, *part;
} parts[] = {{"tutorials", "Tutorials"},
             {"howto", "How-to"},
             {"reference", "Reference"},
             {"operations", "Operations"},
             {"theory", "Theory"}};
enum { PARTS = sizeof parts / sizeof *parts };
static const char last_part[] = "More";

/* Returns the place of the page's part among all parts; 0 for the start page. */
static size_t part_of(const char *name)
{
    const size_t length = strcspn(name, "/");
    if (name[length] == '\0')
        return strcmp(name, "index") == 0 ? 0 : PARTS + 2;
    for (size_t i = 0; i < PARTS; i++)
        if (strlen(parts[i].folder) == length && strncmp(parts[i].folder, name, length) == 0)
            return i + 1;
    return PARTS + 1;
}

static const char *part_title(size_t part)
{
    return part == 0 ? "" : part <= PARTS ? parts[part - 1].part : last_part;
}

/* A page with what decides its place. */
struct placed_page {
    struct orl_guide_page page;
    size_t part, link; /* link: where the start page names it */
};

static int compare_places(const void *a, const void *b)
{
    const struct placed_page *one = a, *other = b;
    if (one->part != other->part)
        return one->part < other->part ? -1 : 1;
    if (one->link != other->link)
        return one->link < other->link ? -1 : 1;
    return strcmp(one->page.name, other->page.name);
}

/* Returns where the start page's HTML has a link to the page; SIZE_MAX if nowhere. */
static size_t find_link(const char *start, const char *name)
{
    char link[ORL_GUIDE_URL];
    const int length = snprintf(link, sizeof link, "\"/guide/%s", name);
    for (const char *at = start; at && (at = strstr(at, link)); at++)
        if (at[length] == '"' || at[length] == '#')
            return (size_t)(at - start);
    return SIZE_MAX;
}

static void order_pages(struct placed_page *pages, size_t count)
{
    const char *start = NULL;
    for (size_t i = 0; i < count; i++)
        if (strcmp(pages[i].page.name, "index") == 0)
            start = pages[i].page.text.html;
    for (size_t i = 0; i < count; i++) {
        pages[i].part = part_of(pages[i].page.name);
        pages[i].page.part = part_title(pages[i].part);
        pages[i].link = find_link(start, pages[i].page.name);
    }
    qsort(pages, count, sizeof *pages, compare_places);
}

/* Renders a file. The caller owns the page's name and text. */
static int render_file(const struct orl_guide_file *file, struct orl_guide_page *ret_page,
                       struct orl_error *err)
{
    char *name = strndup(file->name, strlen(file->name) - strlen(".md"));
    if (!name) {
        orl_error_no_memory(err);
        return ORL_ERR_NOMEM;
    }
    const int rc = orl_guide_render(name, file->bytes, file->size, &ret_page->text, err);
    if (rc) {
        free(name);
        return rc;
    }
    ret_page->name = name;
    ret_page->title =
        ret_page->text.sections[0].heading[0] ? ret_page->text.sections[0].heading : name;
    return 0;
}

static bool is_markdown(const struct orl_guide_file *file)
{
    const size_t length = strlen(file->name);
    return length > 3 && strcmp(file->name + length - 3, ".md") == 0;
}

static void free_page(struct orl_guide_page *page)
{
    free((char *)page->name);
    orl_guide_text_done(&page->text);
}

/* Renders the pages of the list and puts them in order. guide->pages has space for them. */
static int render_pages(struct orl_guide *guide, const struct orl_guide_file *files, size_t count,
                        struct orl_error *err)
{
    int rc = 0;
    size_t made = 0;
    struct placed_page *pages = calloc(count, sizeof *pages);
    if (!pages)
        return orl_error_no_memory(err);
    for (size_t i = 0; rc == 0 && i < count; i++) {
        if (!is_markdown(&files[i]))
            continue;
        rc = render_file(&files[i], &pages[made].page, err);
        made += rc == 0;
    }
    if (rc == 0)
        order_pages(pages, made);
    for (size_t i = 0; i < made; i++) {
        if (rc == 0)
            guide->pages[guide->count++] = pages[i].page;
        else
            free_page(&pages[i].page);
    }
    free(pages);
    return rc;
}

int orl_guide_open(const struct orl_guide_file *files, size_t count, struct orl_guide **ret_guide,
                   struct orl_error *err)
{
    struct orl_guide *guide = calloc(1, sizeof *guide);
    if (!guide)
        return orl_error_no_memory(err);
    guide->pages = calloc(count, sizeof *guide->pages);
    int rc = guide->pages ? render_pages(guide, files, count, err) : orl_error_no_memory(err);
    if (rc == 0)
        rc = orl_guide_index(guide, err);
    if (rc) {
        orl_guide_close(guide);
        return rc;
    }
    *ret_guide = guide;
    return 0;
}

void orl_guide_close(struct orl_guide *guide)
{
    if (!guide)
        return;
    sqlite3_close(guide->index);
    for (size_t i = 0; i < guide->count; i++)
        free_page(&guide->pages[i]);
    free(guide->pages);
    free(guide);
}

size_t orl_guide_count(const struct orl_guide *guide)
{
    return guide->count;
}

const struct orl_guide_page *orl_guide_page_at(const struct orl_guide *guide, size_t index)
{
    return &guide->pages[index];
}

size_t orl_guide_find(const struct orl_guide *guide, const char *name)
{
    size_t index = 0;
    while (index < guide->count && strcmp(guide->pages[index].name, name) != 0)
        index++;
    return index;
}
