/* The full-text index of the guide, and questions to it. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "guide/guide_private.h"

static const char schema[] =
    "CREATE VIRTUAL TABLE sections USING fts5(page UNINDEXED, section UNINDEXED, title, heading, "
    "body, tokenize = \"porter unicode61 remove_diacritics 2\")";
/* Words in a heading count more than in the text. */
static const char find_sections[] =
    "SELECT page, section, snippet(sections, 4, char(1), char(2), '\xe2\x80\xa6', 24) "
    "FROM sections WHERE sections MATCH ?1 ORDER BY bm25(sections, 0, 0, 4, 8, 1), rowid LIMIT ?2";

static int index_error(sqlite3 *index, const char *what, struct orl_error *err)
{
    if (!index || sqlite3_errcode(index) == SQLITE_NOMEM)
        return orl_error_no_memory(err);
    return orl_error_set(err, ORL_ERR_INTERNAL, "cannot %s the guide: %s", what,
                         sqlite3_errmsg(index));
}

static int insert_section(sqlite3_stmt *insert, size_t page, size_t section,
                          const struct orl_guide_page *of)
{
    const struct orl_guide_section *row = &of->text.sections[section];
    sqlite3_bind_int64(insert, 1, (sqlite3_int64)page);
    sqlite3_bind_int64(insert, 2, (sqlite3_int64)section);
    sqlite3_bind_text(insert, 3, of->title, -1, SQLITE_STATIC);
    sqlite3_bind_text(insert, 4, row->heading, -1, SQLITE_STATIC);
    sqlite3_bind_text(insert, 5, row->text, -1, SQLITE_STATIC);
    const int rc = sqlite3_step(insert);
    sqlite3_reset(insert);
    return rc == SQLITE_DONE ? SQLITE_OK : rc;
}

int orl_guide_index(struct orl_guide *guide, struct orl_error *err)
{
    sqlite3_stmt *insert = NULL;
    int rc = sqlite3_open(":memory:", &guide->index);
    if (rc == SQLITE_OK)
        rc = sqlite3_exec(guide->index, schema, NULL, NULL, NULL);
    if (rc == SQLITE_OK)
        rc = sqlite3_prepare_v2(guide->index, "INSERT INTO sections VALUES (?1, ?2, ?3, ?4, ?5)",
                                -1, &insert, NULL);
    if (rc == SQLITE_OK)
        rc = sqlite3_exec(guide->index, "BEGIN", NULL, NULL, NULL);
    for (size_t i = 0; rc == SQLITE_OK && i < guide->count; i++)
        for (size_t k = 0; rc == SQLITE_OK && k < guide->pages[i].text.count; k++)
            rc = insert_section(insert, i, k, &guide->pages[i]);
    if (rc == SQLITE_OK)
        rc = sqlite3_exec(guide->index, "COMMIT", NULL, NULL, NULL);
    const int result = rc == SQLITE_OK ? 0 : index_error(guide->index, "index", err);
    sqlite3_finalize(insert);
    return result;
}

/* ---- Questions ---- */

/* Returns true if the word has a character that the index knows: a letter, a digit, or a part of a
 * character beyond ASCII. */
static bool is_searchable(const char *word, size_t length)
{
    for (size_t i = 0; i < length; i++)
        if (isalnum((unsigned char)word[i]) || (unsigned char)word[i] >= 0x80)
            return true;
    return false;
}

/* Writes a word as a quoted string, which has no operators. The last word may be incomplete. */
static void write_word(FILE *out, const char *word, size_t length, bool is_last)
{
    fputc('"', out);
    for (size_t i = 0; i < length; i++)
        if (word[i] != '"' && (unsigned char)word[i] >= ' ')
            fputc(word[i], out);
    fputs(is_last ? "\"*" : "\"", out);
}

/* Writes the question in the language of FTS5, its words joined by `joint`. Returns it, owned by
 * the caller, or NULL. Fills words and shortened. */
static char *write_expression(const char *question, const char *joint,
                              struct orl_guide_found *found)
{
    static const char blanks[] = " \t\r\n\f\v";
    char *text = NULL;
    size_t size = 0, left = strnlen(question, ORL_GUIDE_QUESTION);
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    found->shortened = question[left] != '\0';
    found->words = 0;
    while (left > 0) {
        const size_t gap = strspn(question, blanks) < left ? strspn(question, blanks) : left;
        size_t length = strcspn(question + gap, blanks);
        if (length > left - gap)
            length = left - gap;
        const bool is_word = is_searchable(question + gap, length);
        if (is_word && found->words == ORL_GUIDE_WORDS) {
            found->shortened = true;
            break;
        }
        if (is_word) {
            fputs(found->words++ ? joint : "", out);
            write_word(out, question + gap, length, gap + length == left);
        }
        question += gap + length;
        left -= gap + length;
    }
    if (fclose(out) != 0) {
        free(text);
        return NULL;
    }
    return text;
}

struct hit_taker {
    void (*take)(void *context, const struct orl_guide_hit *hit);
    void *context;
};

/* Hands out the rows that the expression finds. */
static int take_rows(struct orl_guide *guide, const char *expression, const struct hit_taker *taker,
                     size_t *ret_hits, struct orl_error *err)
{
    sqlite3_stmt *query = NULL;
    size_t hits = 0;
    int rc = sqlite3_prepare_v2(guide->index, find_sections, -1, &query, NULL);
    if (rc == SQLITE_OK) {
        sqlite3_bind_text(query, 1, expression, -1, SQLITE_STATIC);
        sqlite3_bind_int(query, 2, ORL_GUIDE_HITS);
        while ((rc = sqlite3_step(query)) == SQLITE_ROW) {
            const struct orl_guide_page *page = &guide->pages[sqlite3_column_int64(query, 0)];
            const char *snippet = (const char *)sqlite3_column_text(query, 2);
            const struct orl_guide_hit hit = {
                page, &page->text.sections[sqlite3_column_int64(query, 1)], snippet ? snippet : ""};
            taker->take(taker->context, &hit);
            hits++;
        }
    }
    const int result = rc == SQLITE_DONE ? 0 : index_error(guide->index, "search", err);
    sqlite3_finalize(query);
    *ret_hits = hits;
    return result;
}

int orl_guide_search(struct orl_guide *guide, const char *question,
                     void (*take)(void *context, const struct orl_guide_hit *hit), void *context,
                     struct orl_guide_found *ret_found, struct orl_error *err)
{
    static const char *const joints[] = {" AND ", " OR "};
    const struct hit_taker taker = {take, context};
    struct orl_guide_found found = {0};
    int rc = 0;
    for (size_t i = 0; rc == 0 && i < 2 && found.hits == 0; i++) {
        char *expression = write_expression(question, joints[i], &found);
        if (!expression)
            return orl_error_no_memory(err);
        found.only_some = i > 0;
        if (found.words > i)
            rc = take_rows(guide, expression, &taker, &found.hits, err);
        free(expression);
    }
    found.only_some = found.only_some && found.hits > 0;
    if (rc == 0)
        *ret_found = found;
    return rc;
}
