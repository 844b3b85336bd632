/* The table of techniques: names, methods, and facts that agree with each other. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "render/technique/photon_maps.h"

static const enum orl_technique first = ORL_TECHNIQUE_BACKWARD;

static void test_names(void **state)
{
    (void)state;
    assert_string_equal(orl_technique_name(ORL_TECHNIQUE_AUTO), "auto");
    assert_string_equal(orl_technique_name(ORL_TECHNIQUE_COUNT), "unknown");
    for (int i = 0; i < ORL_TECHNIQUE_COUNT; i++)
        for (int k = 0; k < i; k++)
            assert_string_not_equal(orl_technique_name((enum orl_technique)i),
                                    orl_technique_name((enum orl_technique)k));
}

static void test_methods(void **state)
{
    (void)state;
    for (int i = (int)first; i < ORL_TECHNIQUE_COUNT; i++) {
        const struct orl_technique_methods *methods = orl_technique_methods((enum orl_technique)i);
        assert_non_null(methods->create);
        assert_non_null(methods->prepare);
        assert_non_null(methods->compute_sensor);
        assert_non_null(methods->paint_view);
        assert_non_null(methods->destroy);
        methods->destroy(NULL);
    }
}

/* Photons are kept in maps if and only if one is read; what is shown or gathered comes from one. A
 * technique is compared with one that works in another way. */
static void test_facts(void **state)
{
    (void)state;
    for (int i = 0; i < ORL_TECHNIQUE_COUNT; i++) {
        const struct orl_technique_facts *facts = orl_technique_facts((enum orl_technique)i);
        bool any = false;
        for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
            any = any || facts->reads_map[kind];
        assert_int_equal(any, orl_technique_reads_maps((enum orl_technique)i));
        assert_true(any || (!facts->shows_map && facts->final_gather == ORL_GATHER_NOWHERE));
        assert_true(facts->shows_map || !facts->shows_density);
        assert_false(facts->shows_map && facts->final_gather == ORL_GATHER_EVERYWHERE);
        assert_true(any != orl_technique_reads_maps(facts->alternative));
    }
}

/* Returns true if the estimator agrees with the technique's facts. */
static bool agree(const struct orl_indirect_estimator *indirect,
                  const struct orl_technique_facts *facts)
{
    return facts->reads_map[indirect->map] &&
           indirect->gathered == (facts->final_gather == ORL_GATHER_EVERYWHERE) &&
           indirect->knows_spread == (facts->final_gather == ORL_GATHER_WHERE_DOUBTFUL) &&
           (indirect->at_surface != NULL) == facts->shows_map && indirect->at_hit;
}

static void test_estimators(void **state)
{
    (void)state;
    assert_true(agree(&orl_indirect_gathered, orl_technique_facts(ORL_TECHNIQUE_GATHER)));
    assert_true(agree(&orl_indirect_density, orl_technique_facts(ORL_TECHNIQUE_DIRECT)));
    assert_true(agree(&orl_indirect_records, orl_technique_facts(ORL_TECHNIQUE_PRECOMPUTED)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_names), cmocka_unit_test(test_methods),
                                       cmocka_unit_test(test_facts),
                                       cmocka_unit_test(test_estimators)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
