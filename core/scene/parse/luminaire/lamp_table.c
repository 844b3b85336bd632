#include "scene/parse/luminaire/luminaires.h"

#include <ctype.h>
#include <string.h>

#include <oriel/base/scanner.h>

#include "scene/material/patterns/observer.h"

/* A range of text. */
struct span {
    const char *at, *end;
};

/* ---- Patterns -------------------------------------------------------------------------------- */

enum kind { LETTER, ANY, SET, NOT_IN_SET, WORD_BEGINS, WORD_ENDS, TEXT_ENDS };

/* One element of a pattern. */
struct item {
    enum kind kind;
    char letter;
    struct span set;
    bool repeated;
};

struct search {
    struct span words;
    long *steps;
};

static bool is_of_word(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

/* Reads "[...]", whose first character may be ']'; without an end the rest is the set. */
static struct item read_set(struct span *pattern)
{
    const bool without = pattern->at < pattern->end && *pattern->at == '^';
    struct item item = {.kind = without ? NOT_IN_SET : SET};
    const char *const first = pattern->at + without;
    const char *end = first < pattern->end ? first + 1 : first;
    while (end < pattern->end && *end != ']')
        end++;
    item.set = (struct span){first, end};
    pattern->at = end < pattern->end ? end + 1 : end;
    return item;
}

static struct item read_item(struct span *pattern)
{
    const char c = *pattern->at++;
    struct item item = {.kind = c == '.' ? ANY : LETTER, .letter = c};
    if (c == '[')
        item = read_set(pattern);
    else if (c == '$' && pattern->at == pattern->end)
        item.kind = TEXT_ENDS;
    else if (c == '\\' && pattern->at < pattern->end)
        item.letter = *pattern->at++;
    if (c == '\\' && item.letter != '\\')
        item.kind = item.letter == '<' ? WORD_BEGINS : item.letter == '>' ? WORD_ENDS : LETTER;
    if (item.kind < WORD_BEGINS && pattern->at < pattern->end && *pattern->at == '*') {
        item.repeated = true;
        pattern->at++;
    }
    return item;
}

static bool is_in_set(struct span set, char c)
{
    while (set.at < set.end) {
        const bool range = set.end - set.at > 2 && set.at[1] == '-';
        if (range ? c >= set.at[0] && c <= set.at[2] : c == *set.at)
            return true;
        set.at += range ? 3 : 1;
    }
    return false;
}

/* Returns true if the character matches the item. */
static bool matches_character(const struct item *item, const struct search *search, const char *at)
{
    if (at == search->words.end)
        return false;
    if (item->kind == SET || item->kind == NOT_IN_SET)
        return is_in_set(item->set, *at) == (item->kind == SET);
    return item->kind == ANY || tolower((unsigned char)item->letter) == tolower((unsigned char)*at);
}

/* Returns true if a zero-width condition holds at a position. */
static bool matches_position(enum kind kind, const struct search *search, const char *at)
{
    const bool before = at > search->words.at && is_of_word(at[-1]);
    const bool after = at < search->words.end && is_of_word(*at);
    return kind == WORD_BEGINS ? after && !before
           : kind == WORD_ENDS ? !after
                               : at == search->words.end;
}

/* Returns true if the pattern matches the words at that position. It recurses only at '*'. */
static bool matches(struct search *search, struct span pattern, const char *at)
{
    while (pattern.at < pattern.end) {
        const struct item item = read_item(&pattern);
        const char *last = at;
        if (--*search->steps < 0)
            return false;
        if (item.repeated) {
            while (matches_character(&item, search, last))
                last++;
            *search->steps -= last - at;
            for (; last > at; last--)
                if (matches(search, pattern, last))
                    return true;
        } else if (item.kind >= WORD_BEGINS) {
            if (!matches_position(item.kind, search, at))
                return false;
        } else if (!matches_character(&item, search, at++)) {
            return false;
        }
    }
    return true;
}

static bool is_in(struct span pattern, struct span words, long *steps)
{
    struct search search = {words, steps};
    const bool fixed = pattern.at < pattern.end && *pattern.at == '^';
    pattern.at += fixed;
    for (const char *at = words.at; at == words.at || (at <= words.end && !fixed); at++)
        if (matches(&search, pattern, at))
            return true;
    return false;
}

/* ---- Lines ----------------------------------------------------------------------------------- */

struct entry {
    struct span pattern, rest; /* rest: text behind the pattern */
};

static int fail(const struct orl_lamp_table *table, int line, int code, const char *what,
                struct orl_error *err)
{
    orl_error_set(err, code, "%s", what);
    orl_error_at(err, table->name, line, NULL);
    return code;
}

/* Returns the next such character that no backslash precedes, or the end. */
static const char *find_end(struct span span, char c)
{
    for (const char *at = span.at; at < span.end; at++)
        if (*at == c && (at == span.at || at[-1] != '\\'))
            return at;
    return span.end;
}

/* Returns 1 for an entry, 0 for a blank or comment line. Patterns are limited in length, because
 * matching recurses. */
static int read_entry(const struct orl_lamp_table *table, int number, struct orl_slice text,
                      struct entry *ret, struct orl_error *err)
{
    enum { LONGEST = 250 };
    text = orl_slice_trim(text);
    if (text.length == 0 || *text.text == '#')
        return 0;
    struct span line = {text.text, text.text + text.length};
    const char delimiter = *line.at++;
    ret->pattern = (struct span){line.at, find_end(line, delimiter)};
    if (ret->pattern.end == line.end)
        return fail(table, number, ORL_ERR_SYNTAX, "a lamp's pattern is not closed", err);
    if (ret->pattern.end - ret->pattern.at > LONGEST)
        return fail(table, number, ORL_ERR_LIMIT, "a lamp's pattern is too long", err);
    ret->rest = (struct span){ret->pattern.end + 1, line.end};
    while (ret->rest.at < line.end && orl_byte_kind_of(*ret->rest.at) == ORL_BYTE_BLANK)
        ret->rest.at++;
    return 1;
}

/* Reads "x y share". */
static int read_lamp(const struct orl_lamp_table *table, int line, struct span rest,
                     struct orl_lamp_entry *ret, struct orl_error *err)
{
    static const char what[] = "x, y and the share of light, or another lamp's name in (), are "
                               "expected after a lamp's pattern";
    const struct orl_scanner scanner = {.name = table->name, .line = line};
    double *const numbers[] = {&ret->x, &ret->y, &ret->share};
    struct orl_slice left = {rest.at, (size_t)(rest.end - rest.at)};
    for (int i = 0; i < 3; i++) {
        const struct orl_slice word = orl_slice_take_word(&left);
        const int code = word.length > 0 ? orl_scanner_number(&scanner, word, what, numbers[i], err)
                                         : fail(table, line, ORL_ERR_SYNTAX, what, err);
        if (code < 0)
            return code;
    }
    const double x = ret->x, y = ret->y, share = ret->share;
    if (!(x >= 0 && y >= 1e-3 && x + y <= 1 && share >= 0 && share <= 1e6))
        return fail(table, line, ORL_ERR_RANGE,
                    "a lamp's x y are not a colour, or its share is below 0", err);
    ret->color = orl_tristimulus_rgb(
        (struct orl_tristimulus){x / y * share, share, (1 - x - y) / y * share});
    return 1;
}

/* Finds the first entry before a line whose pattern matches the words; returns its line, or 0. */
static int find_entry(struct orl_lamp_table *table, struct span words, int before,
                      struct entry *ret, struct orl_error *err)
{
    struct orl_scanner scanner;
    struct orl_slice line;
    int code = orl_scanner_init(&scanner, table->name, table->text, table->size, 0, err);
    if (code < 0)
        return code;
    while (orl_scanner_line(&scanner, &line) && scanner.line < before) {
        const int number = scanner.line;
        code = read_entry(table, number, line, ret, err);
        if (code < 0)
            return code;
        if (code > 0 && is_in(ret->pattern, words, &table->steps))
            return number;
        if (table->steps < 0)
            return fail(table, number, ORL_ERR_LIMIT, "the lamp patterns take too long to match",
                        err);
    }
    return 0;
}

int orl_lamp_find(struct orl_lamp_table *table, const char *words, size_t length,
                  struct orl_lamp_entry *ret_lamp, struct orl_error *err)
{
    enum { LONGEST = 32 }; /* each name is searched from the first line on */
    struct span wanted = {words, words + length};
    struct entry entry;
    int line = find_entry(table, wanted, 1 << 30, &entry, err);
    for (int n = 0; line > 0 && entry.rest.at < entry.rest.end && *entry.rest.at == '('; n++) {
        const int named = line;
        if (n == LONGEST)
            return fail(table, named, ORL_ERR_LIMIT, "the chain of lamp names is too long", err);
        wanted.at = entry.rest.at + 1;
        wanted.end = find_end((struct span){wanted.at, entry.rest.end}, ')');
        line = find_entry(table, wanted, named, &entry, err);
        if (line == 0)
            return fail(table, named, ORL_ERR_SYNTAX, "no lamp before this line has that name",
                        err);
    }
    return line > 0 ? read_lamp(table, line, entry.rest, ret_lamp, err) : line;
}
