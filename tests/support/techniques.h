/* cmocka tests shared by several techniques: one function, with the technique as its state. */
#ifndef ORL_TESTS_SUPPORT_TECHNIQUES_H
#define ORL_TESTS_SUPPORT_TECHNIQUES_H

#include <oriel/job/plan.h>
#include <stdint.h>

/* An entry of the list of tests, named after the test and the technique. */
#define OF_TECHNIQUE(test, name)                                                                   \
    {                                                                                              \
#test "_" #name, test, NULL, NULL, (void *)(uintptr_t)ORL_TECHNIQUE_##name                 \
    }

static inline enum orl_technique of_technique(void **state)
{
    return (enum orl_technique)(uintptr_t)*state;
}

#endif
