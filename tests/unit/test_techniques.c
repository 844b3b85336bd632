/* The table of techniques: names, methods, and facts that agree with each other. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "render/technique/photon_maps.h"

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

static const struct orl_technique_definition *const definitions[] = {
    &orl_backward_technique, &orl_gather_technique, &orl_direct_technique,
    &orl_precomputed_technique};

static void test_methods(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof definitions / sizeof *definitions; i++) {
        const struct orl_technique_methods *methods = definitions[i]->methods;
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

/* A technique has an estimator if and only if it reads maps, and both state alike what is gathered
 * and what is read. */
static void test_estimators(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof definitions / sizeof *definitions; i++) {
        const struct orl_technique_facts *facts = &definitions[i]->facts;
        const struct orl_indirect_estimator *indirect = definitions[i]->indirect;
        assert_int_equal(indirect != NULL, facts->photons == ORL_PHOTONS_FOR_MAPS);
        if (!indirect)
            continue;
        assert_true(facts->reads_map[indirect->map]);
        assert_int_equal(indirect->gathered, facts->final_gather == ORL_GATHER_EVERYWHERE);
        assert_int_equal(indirect->knows_spread, facts->final_gather == ORL_GATHER_WHERE_DOUBTFUL);
        assert_int_equal(indirect->at_surface != NULL, facts->shows_map);
        assert_non_null(indirect->at_hit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_names), cmocka_unit_test(test_methods),
                                       cmocka_unit_test(test_facts),
                                       cmocka_unit_test(test_estimators)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
