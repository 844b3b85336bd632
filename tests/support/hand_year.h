/*
 * A synthetic year of light for tests of derived metrics: hourly rows, lit from 6 to 18; sensor i
 * has 100 (i + 1) lx, and sensors 4 and 5 have 5000 lx more of direct sunlight at noon. Functions
 * fail the running test when out of memory.
 */
#ifndef ORL_TESTS_SUPPORT_HAND_YEAR_H
#define ORL_TESTS_SUPPORT_HAND_YEAR_H

#include <stdbool.h>

#include <oriel/annual/annual_report.h>

enum { HAND_YEAR_SENSORS = 6, HAND_YEAR_FIRST_LIT = 6, HAND_YEAR_LIT = 12 };

void hand_year_make(struct orl_annual_result *result, bool leap);
void hand_year_free(struct orl_annual_result *result);

/*
 * Returns a request of two grids, two sensors in the north and four in the south; it borrows grids.
 */
struct orl_annual_request hand_year_request(struct orl_annual_grid grids[2]);

/* Requests one target, and rules by name; freed by orl_report_request_done. */
void hand_year_ask(struct orl_report_request *report_request, const char *target,
                   const char *rules);

/* Returns the report, freed by orl_annual_report_done; an error fails the running test. */
struct orl_annual_report hand_year_report(const struct orl_annual_request *request,
                                          const struct orl_annual_result *result,
                                          const struct orl_report_request *report_request);

#endif
