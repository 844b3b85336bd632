/* The user guide: rendering, order and search, with pages written here; then the pages of
 * client/guide itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "guide/guide.h"

static void render(const char *name, const char *markdown, struct orl_guide_text *ret_text)
{
    struct orl_error err = {0};
    if (orl_guide_render(name, markdown, strlen(markdown), ret_text, &err) != 0)
        fail_msg("%s", err.message);
}

/* Renders a page, and checks that its HTML has a text. */
static void expect_html(const char *markdown, const char *wanted)
{
    struct orl_guide_text page;
    render("howto/x", markdown, &page);
    if (!strstr(page.html, wanted))
        fail_msg("'%s' is not in %s", wanted, page.html);
    orl_guide_text_done(&page);
}

static void test_html(void **state)
{
    (void)state;
    expect_html("# A & B\n", "<h1>A &amp; B</h1>");
    expect_html("# A\n## C `d`\n",
                "<h2 id=\"c-d\">C <code>d</code><a class=\"anchor\" href=\"#c-d\"");
    expect_html("| a |\n|---|\n| 1 |\n", "tabindex=\"0\" aria-label=\"Table\"><table>");
    expect_html("```sh test\nls <x>\n```\n",
                "<pre tabindex=\"0\"><code class=\"language-sh\">ls &lt;x&gt;\n");
    expect_html("a <script>b</script>\n", "a &lt;script&gt;b");
    expect_html("[y](y.md#z)", "<a href=\"/guide/howto/y#z\">y</a>");
    expect_html("![p](../pictures/p.png \"t\")",
                "<img src=\"/guide/pictures/p.png\" alt=\"p\" title=\"t\">");
    expect_html("[c](../../../core/glossary.md)", "<a>c</a>");
    struct orl_guide_text page;
    render("x", "# T\n\n<!-- test: hidden -->\n\nseen\n", &page);
    assert_null(strstr(page.html, "hidden"));
    assert_non_null(strstr(page.html, "seen"));
    orl_guide_text_done(&page);
}

static void test_links(void **state)
{
    static const char *const cases[][3] = {
        {"howto/a", "b.md", "/guide/howto/b"},
        {"howto/a", "./b.md#c", "/guide/howto/b#c"},
        {"howto/a", "../theory/b.md#c-d", "/guide/theory/b#c-d"},
        {"howto/a", "../index.md", "/guide"},
        {"index", "howto/a.md", "/guide/howto/a"},
        {"index", "pictures/p.svg", "/guide/pictures/p.svg"},
        {"index", "https://example.org/x.md", "https://example.org/x.md"},
        {"index", "#part", "#part"},
        {"index", "/openapi.yaml", "/openapi.yaml"},
        {"howto/a", "../../javascript/oriel.js", "/oriel.js"},
        {"howto/a", "../../../README.md", ""},
        {"howto/a", "../../../../../etc/passwd", ""},
    };
    char url[ORL_GUIDE_URL], longer[1000];
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_string_equal(orl_guide_resolve(cases[i][0], cases[i][1], url), cases[i][2]);
    memset(longer, 'x', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    assert_string_equal(orl_guide_resolve("a", longer, url), "");
}

static void test_sections(void **state)
{
    struct orl_guide_text page;
    (void)state;
    render("x",
           "# Title\nfirst *words*\n\n## Set up: `--parts`!\nsecond & third\n\n- x\n- y\n\n"
           "## Set up: `--parts`!\n### Größe\nfourth\n",
           &page);
    assert_int_equal(page.count, 4);
    assert_string_equal(page.sections[0].heading, "Title");
    assert_string_equal(page.sections[0].anchor, "");
    assert_non_null(strstr(page.sections[0].text, "first words"));
    assert_string_equal(page.sections[1].heading, "Set up: --parts!");
    assert_string_equal(page.sections[1].anchor, "set-up---parts");
    assert_non_null(strstr(page.sections[1].text, "second & third"));
    assert_null(strstr(page.sections[1].text, "Set up"));
    assert_null(strstr(page.sections[1].text, "xy"));
    assert_string_equal(page.sections[2].anchor, "set-up---parts-1");
    assert_string_equal(page.sections[3].anchor, "größe");
    assert_int_equal(page.sections[3].level, 3);
    orl_guide_text_done(&page);
}

#define PAGE(name, text)                                                                           \
    {                                                                                              \
        name, "text/markdown; charset=utf-8", "", sizeof(text) - 1, text                           \
    }

static const struct orl_guide_file own_files[] = {
    PAGE("glossary.md", "# Glossary\nPhoton map, sensor.\n"),
    PAGE("howto/a.md",
         "# Tokens\nA daemon asks for tokens.\n## Expiry\nA session lasts twelve hours.\n"),
    PAGE("howto/b.md", "# Weather\nGive `weather_file` to the year. The option is --parts.\n"),
    PAGE("index.md", "# Start\n[b](howto/b.md), [a](howto/a.md)\n"),
    PAGE("tutorials/z.md",
         "# A room\nRender a room. Photons rendered it. Tokens are not needed.\n"),
    {"pictures/p.png", "image/png", "", 1, "x"},
};

static struct orl_guide *open_own(void)
{
    struct orl_guide *guide = NULL;
    struct orl_error err = {0};
    if (orl_guide_open(own_files, sizeof own_files / sizeof *own_files, &guide, &err) != 0)
        fail_msg("%s", err.message);
    return guide;
}

static void test_order(void **state)
{
    static const char *const wanted[][2] = {{"index", ""},
                                            {"tutorials/z", "Tutorials"},
                                            {"howto/b", "How-to"},
                                            {"howto/a", "How-to"},
                                            {"glossary", "More"}};
    struct orl_guide *guide = open_own();
    (void)state;
    assert_int_equal(orl_guide_count(guide), 5);
    for (size_t i = 0; i < 5; i++) {
        assert_string_equal(orl_guide_page_at(guide, i)->name, wanted[i][0]);
        assert_string_equal(orl_guide_page_at(guide, i)->part, wanted[i][1]);
        assert_int_equal(orl_guide_find(guide, wanted[i][0]), i);
    }
    assert_int_equal(orl_guide_find(guide, "pictures/p.png"), 5);
    orl_guide_close(guide);
}

/* The first hit of a question, as "page#anchor: snippet". */
static void note_hit(void *context, const struct orl_guide_hit *hit)
{
    char *text = context;
    if (!*text)
        snprintf(text, 400, "%s#%s: %s", hit->page->name, hit->section->anchor, hit->snippet);
}

static struct orl_guide_found ask_guide(struct orl_guide *guide, const char *question,
                                        char ret_first[400])
{
    struct orl_guide_found found = {0};
    struct orl_error err = {0};
    ret_first[0] = '\0';
    if (orl_guide_search(guide, question, note_hit, ret_first, &found, &err) != 0)
        fail_msg("'%s': %s", question, err.message);
    return found;
}

static void test_search(void **state)
{
    static const struct {
        const char *question, *first;
        size_t hits;
        bool only_some;
    } cases[] = {
        {"tokens", "howto/a#: ", 3, false}, /* the title counts more than the text */
        {"SESSION hours", "howto/a#expiry: ", 1, false},
        {"rendering", "tutorials/z#: ", 1, false}, /* by its stem */
        {"weath", "howto/b#: ", 1, false},         /* the last word may be incomplete */
        {"weather_file", "howto/b#: ", 1, false},
        {"--parts", "howto/b#: ", 1, false},
        {"session weather", "howto/", 2, true},
        {"xylophone", "", 0, false},
        {"", "", 0, false},
    };
    struct orl_guide *guide = open_own();
    char first[400];
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct orl_guide_found found = ask_guide(guide, cases[i].question, first);
        if (strncmp(first, cases[i].first, strlen(cases[i].first)) != 0 ||
            found.hits != cases[i].hits || found.only_some != cases[i].only_some)
            fail_msg("'%s': %zu hits, first %s", cases[i].question, found.hits, first);
    }
    ask_guide(guide, "session", first);
    assert_non_null(strstr(first, "A \1session\2 lasts"));
    orl_guide_close(guide);
}

/* No question is an error, and long ones are cut. */
static void test_hostile_questions(void **state)
{
    static const char *const questions[] = {"\"",
                                            "\"\"",
                                            "*",
                                            "(",
                                            ")",
                                            "NEAR(",
                                            "a OR",
                                            "AND",
                                            "NOT a",
                                            "title : x",
                                            "{a b} : c",
                                            "^a",
                                            "-a",
                                            "a + b",
                                            "';DROP TABLE sections--",
                                            "\xe2\x80\x93",
                                            "\xff\xfe",
                                            "\x01\x02",
                                            "a\"b",
                                            "\\",
                                            "%",
                                            "?1",
                                            "\"a",
                                            "a* b*",
                                            "\xc3"};
    struct orl_guide *guide = open_own();
    char first[400], longer[5000];
    (void)state;
    for (size_t i = 0; i < sizeof questions / sizeof *questions; i++)
        ask_guide(guide, questions[i], first);
    memset(longer, 'x', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    assert_true(ask_guide(guide, longer, first).shortened);
    for (size_t i = 0; i + 1 < sizeof longer; i += 2)
        memcpy(longer + i, "a ", 2);
    const struct orl_guide_found found = ask_guide(guide, longer, first);
    assert_true(found.shortened);
    assert_int_equal(found.words, ORL_GUIDE_WORDS);
    assert_int_equal(ask_guide(guide, "tokens", first).hits, 3); /* the index is as it was */
    orl_guide_close(guide);
}

/* ---- The pages of client/guide ---- */

static bool has_anchor(const struct orl_guide_page *page, const char *anchor)
{
    for (size_t i = 0; i < page->text.count; i++)
        if (strcmp(page->text.sections[i].anchor, anchor) == 0)
            return true;
    return false;
}

/* Returns true if the daemon serves the address of a link on the page. */
static bool is_served(const struct orl_guide *guide, const struct orl_guide_page *page,
                      const char *url)
{
    char name[ORL_GUIDE_URL];
    size_t count = 0;
    const struct orl_guide_file *files = orl_guide_files(&count);
    if (url[0] == '#')
        return has_anchor(page, url + 1);
    if (strncmp(url, "/guide", 6) != 0 || strncmp(url, "/guide/search", 13) == 0)
        return true;
    const char *fragment = url + strcspn(url, "#");
    snprintf(name, sizeof name, "%.*s", (int)(fragment - url), url);
    for (size_t i = 0; i < count; i++)
        if (strcmp(files[i].name, name[6] ? name + 7 : "") == 0)
            return true;
    const size_t found = orl_guide_find(guide, name[6] ? name + 7 : "index");
    return found < orl_guide_count(guide) &&
           (!*fragment || has_anchor(orl_guide_page_at(guide, found), fragment + 1));
}

static size_t check_addresses(const struct orl_guide *guide, const struct orl_guide_page *page,
                              const char *attribute)
{
    size_t dead = 0;
    for (const char *at = page->text.html; (at = strstr(at, attribute));) {
        char url[ORL_GUIDE_URL];
        at += strlen(attribute);
        snprintf(url, sizeof url, "%.*s", (int)strcspn(at, "\""), at);
        if (!is_served(guide, page, url)) {
            print_error("%s: %s leads nowhere\n", page->name, url);
            dead++;
        }
    }
    return dead;
}

static void test_own_guide(void **state)
{
    struct orl_guide *guide = NULL;
    struct orl_error err = {0};
    size_t count = 0, dead = 0;
    const struct orl_guide_file *files = orl_guide_files(&count);
    (void)state;
    assert_int_equal(orl_guide_open(files, count, &guide, &err), 0);
    assert_string_equal(orl_guide_page_at(guide, 0)->name, "index");
    for (size_t i = 0; i < orl_guide_count(guide); i++) {
        const struct orl_guide_page *page = orl_guide_page_at(guide, i);
        if (page->title == page->name ||
            strncmp(page->text.html + strspn(page->text.html, " \n"), "<h1>", 4) != 0)
            fail_msg("%s does not begin with its title", page->name);
        const char *slash = strchr(page->name, '/');
        if (slash && strchr(slash + 1, '/'))
            fail_msg("%s is too deep for the routes", page->name);
        dead += check_addresses(guide, page, "href=\"");
        dead += check_addresses(guide, page, "src=\"");
    }
    assert_int_equal(dead, 0);
    orl_guide_close(guide);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_html),      cmocka_unit_test(test_links),
        cmocka_unit_test(test_sections),  cmocka_unit_test(test_order),
        cmocka_unit_test(test_search),    cmocka_unit_test(test_hostile_questions),
        cmocka_unit_test(test_own_guide),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
