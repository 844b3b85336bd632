/* Content negotiation: the client's preferences in Accept and Accept-Encoding. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "http/request/parse_request.h"

static void test_weights(void **state)
{
    static const struct {
        const char *header, *name;
        double weight;
    } cases[] = {
        {NULL, "text/html", 0},
        {"", "text/html", 0},
        {"text/html", "text/html", 1},
        {"TEXT/HTML", "text/html", 1},
        {"text/html;q=0.25", "text/html", 0.25},
        {"text/html; Q=0.5, */*", "text/html", 0.5},
        {"text/html;level=1;q=0.5", "text/html", 0.5},
        {"*/*;q=0.8, text/html", "text/html", 1},
        {"*/*;q=0.8, text/html", "application/json", 0.8},
        {"text/*;q=0.3, */*;q=0.8", "text/html", 0.3},
        {"text/*;q=0.3, */*;q=0.8", "application/json", 0.8},
        {"application/json, text/html;q=0", "text/html", 0},
        {"text/htmlx, xtext/html", "text/html", 0},
        {"text/html;q=2", "text/html", 0},
        {"text/html;q=x", "text/html", 0},
        {"text/html;q=1.000", "text/html", 1},
        {"text/html;q=0.125", "text/html", 0.125},
        {",,;,", "text/html", 0},
        {"gzip, deflate, br", "gzip", 1},
        {"gzip;q=0", "gzip", 0},
        {"identity, *;q=0.5", "gzip", 0.5},
        {"*/*", "gzip", 0},
        {"x-gzip", "gzip", 0},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double weight = orl_negotiate_weight(cases[i].header, cases[i].name);
        if (weight < cases[i].weight - 1e-12 || weight > cases[i].weight + 1e-12)
            fail_msg("%s for %s: %g, not %g", cases[i].header, cases[i].name, weight,
                     cases[i].weight);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_weights)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
