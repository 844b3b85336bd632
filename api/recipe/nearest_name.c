#include "recipe/nearest_name.h"

#include <string.h>

enum { LONGEST = 64 };

static size_t least_of(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Returns the edits between two words, by the rows of the usual table; LONGEST if one is longer. */
static size_t edits_between(const char *a, const char *b)
{
    size_t row[LONGEST + 1];
    const size_t n = strlen(b);
    if (n > LONGEST || strlen(a) > LONGEST)
        return LONGEST;
    for (size_t j = 0; j <= n; j++)
        row[j] = j;
    for (size_t i = 1; a[i - 1]; i++) {
        size_t above_left = row[0];
        row[0] = i;
        for (size_t j = 1; j <= n; j++) {
            const size_t replaced = above_left + (a[i - 1] != b[j - 1]);
            above_left = row[j];
            row[j] = least_of(replaced, 1 + least_of(row[j], row[j - 1]));
        }
    }
    return row[n];
}

void orl_nearest_name_offer(struct orl_nearest_name *nearest, const char *name)
{
    const size_t edits = edits_between(nearest->wanted, name);
    if (edits > 1 + strlen(name) / 3 || (nearest->best && edits >= nearest->distance))
        return;
    nearest->best = name;
    nearest->distance = edits;
}
