#include <oriel/base/suggest.h>

#include <stdbool.h>
#include <string.h>

/* Returns the letter as compared: lower case, with one sign for all separators. */
static char fold_letter(char c)
{
    if (c >= 'A' && c <= 'Z')
        return (char)(c - 'A' + 'a');
    return c == '_' || c == ' ' ? '-' : c;
}

static unsigned least_of(unsigned a, unsigned b)
{
    return a < b ? a : b;
}

/* Returns the optimal string alignment distance of two words of at most ORL_SUGGEST_LETTERS
 * letters. Only the last three rows of the table are kept. */
static unsigned distance_of(const char *a, size_t n_a, const char *b, size_t n_b)
{
    unsigned rows[3][ORL_SUGGEST_LETTERS + 1];
    for (size_t k = 0; k <= n_b; k++)
        rows[0][k] = (unsigned)k;
    for (size_t i = 1; i <= n_a; i++) {
        unsigned *const row = rows[i % 3], *const above = rows[(i + 2) % 3],
                        *const second = rows[(i + 1) % 3];
        row[0] = (unsigned)i;
        for (size_t k = 1; k <= n_b; k++) {
            const char x = fold_letter(a[i - 1]), y = fold_letter(b[k - 1]);
            row[k] = least_of(least_of(above[k], row[k - 1]) + 1, above[k - 1] + (x != y));
            if (i > 1 && k > 1 && x == fold_letter(b[k - 2]) && y == fold_letter(a[i - 2]))
                row[k] = least_of(row[k], second[k - 2] + 1);
        }
    }
    return rows[n_a % 3][n_b];
}

static bool begins_with(const char *known, const char *word, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (fold_letter(known[i]) != fold_letter(word[i]))
            return false;
    return true;
}

/* Returns the largest distance at which a word of that length is still recognised. */
static unsigned most_for(size_t letters)
{
    return letters < 3 ? 0 : letters < 6 ? 1 : letters < 10 ? 2 : 3;
}

void orl_suggestion_add(struct orl_suggestion *suggestion, const char *known)
{
    enum { LEAST_PREFIX = 3 };
    const char *const word = suggestion->word;
    const size_t n_word = strlen(word), n_known = strlen(known);
    if (n_word == 0 || n_word > ORL_SUGGEST_LETTERS || n_known > ORL_SUGGEST_LETTERS)
        return;
    unsigned distance = distance_of(word, n_word, known, n_known);
    if (distance > 1 && n_word >= LEAST_PREFIX && n_word < n_known &&
        begins_with(known, word, n_word))
        distance = 1;
    if (distance > most_for(n_word > n_known ? n_word : n_known) ||
        (suggestion->best && distance >= suggestion->distance))
        return;
    suggestion->best = known;
    suggestion->distance = distance;
}

const char *orl_suggest(const char *word, const char *const *words, size_t n_words)
{
    struct orl_suggestion suggestion = {.word = word};
    for (size_t i = 0; i < n_words; i++)
        orl_suggestion_add(&suggestion, words[i]);
    return suggestion.best;
}

void orl_suggestion_hint(const struct orl_suggestion *suggestion, struct orl_error *err)
{
    char rest[ORL_ERROR_TEXT_MAX];
    if (!suggestion->best || !err)
        return;
    memcpy(rest, err->hint, sizeof rest);
    orl_error_hint(err, "did you mean \"%s\"?%s%s", suggestion->best, rest[0] ? " " : "", rest);
}
