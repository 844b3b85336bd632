/* Requirements of standards and labels, as targets. */
#include <oriel/annual/annual_metrics.h>

#include <string.h>
#include <strings.h>

#define EN_17037 "EN 17037:2018, 5.1 and annex A, by climate data; half of the daylight hours"
#define EN_17037_DF                                                                                \
    "EN 17037:2018, 5.1 and annex A, by daylight factor; of the median diffuse illuminance"
#define LEED "LEED v4.1, EQ Daylight, option 1; blinds are as in the series"
#define WELL "WELL v2, Q2 2025"
#define BREEAM                                                                                     \
    "BREEAM Hea 01, illuminance averages; of each room, and credits by the area of rooms that "    \
    "pass"

enum { AS_MODELLED = false, WITH_BLINDS = true };

static const struct orl_annual_rule rules[] = {
    {"EN 17037 minimum",
     EN_17037,
     {"sDA300/50 in daylight hours >= 50 %", "sDA100/50 in daylight hours >= 95 %"},
     AS_MODELLED},
    {"EN 17037 medium",
     EN_17037,
     {"sDA500/50 in daylight hours >= 50 %", "sDA300/50 in daylight hours >= 95 %"},
     AS_MODELLED},
    {"EN 17037 high",
     EN_17037,
     {"sDA750/50 in daylight hours >= 50 %", "sDA500/50 in daylight hours >= 95 %"},
     AS_MODELLED},
    {"roof lights by EN 17037 minimum",
     EN_17037,
     {"sDA300/50 in daylight hours >= 95 %"},
     AS_MODELLED},
    {"roof lights by EN 17037 medium",
     EN_17037,
     {"sDA500/50 in daylight hours >= 95 %"},
     AS_MODELLED},
    {"roof lights by EN 17037 high",
     EN_17037,
     {"sDA750/50 in daylight hours >= 95 %"},
     AS_MODELLED},
    {"daylight factor by EN 17037 minimum",
     EN_17037_DF,
     {"sDF300lx >= 50 %", "sDF100lx >= 95 %"},
     AS_MODELLED},
    {"daylight factor by EN 17037 medium",
     EN_17037_DF,
     {"sDF500lx >= 50 %", "sDF300lx >= 95 %"},
     AS_MODELLED},
    {"daylight factor by EN 17037 high",
     EN_17037_DF,
     {"sDF750lx >= 50 %", "sDF500lx >= 95 %"},
     AS_MODELLED},
    {"daylight factor of roof lights by EN 17037 minimum",
     EN_17037_DF,
     {"sDF300lx >= 95 %"},
     AS_MODELLED},
    {"daylight factor of roof lights by EN 17037 medium",
     EN_17037_DF,
     {"sDF500lx >= 95 %"},
     AS_MODELLED},
    {"daylight factor of roof lights by EN 17037 high",
     EN_17037_DF,
     {"sDF750lx >= 95 %"},
     AS_MODELLED},
    {"LEED v4.1, 1 point", LEED, {"sDA300/50 >= 40 %"}, WITH_BLINDS},
    {"LEED v4.1, 2 points", LEED, {"sDA300/50 >= 55 %"}, WITH_BLINDS},
    {"LEED v4.1, 3 points", LEED, {"sDA300/50 >= 75 %"}, WITH_BLINDS},
    {"LEED v4.1, no note on glare",
     LEED "; above it the design has to say how glare is met",
     {"ASE1000,250 <= 10 %"},
     AS_MODELLED},
    {"WELL L01 by LM-83", WELL, {"sDA150/50 >= 30 %"}, WITH_BLINDS},
    {"WELL L01 by EN 17037", WELL, {"sDA200/50 in daylight hours >= 30 %"}, AS_MODELLED},
    {"WELL L06 tier 1 by LM-83", WELL, {"sDA300/50 >= 55 %"}, WITH_BLINDS},
    {"WELL L06 tier 1 by EN 17037", WELL, {"sDA300/50 in daylight hours >= 50 %"}, AS_MODELLED},
    {"WELL L06 tier 2 by LM-83", WELL, {"sDA300/50 >= 75 %"}, WITH_BLINDS},
    {"WELL L06 tier 2 by EN 17037",
     WELL,
     {"sDA300/50 in daylight hours >= 50 %", "sDA100/50 in daylight hours >= 95 %"},
     AS_MODELLED},
    {"BREEAM offices",
     BREEAM " (80 %)",
     {"hours300 of mean >= 2000 h", "least hours90 >= 2000 h"},
     AS_MODELLED},
    {"BREEAM education",
     BREEAM " (80 %; higher education 60 % for one credit)",
     {"hours300 of mean >= 2000 h", "least hours90 >= 2000 h"},
     AS_MODELLED},
    {"BREEAM healthcare, 1 credit",
     BREEAM " (80 %)",
     {"hours300 of mean >= 2000 h", "least hours90 >= 2000 h"},
     AS_MODELLED},
    {"BREEAM healthcare, 2 credits",
     BREEAM " (80 %)",
     {"hours300 of mean >= 2650 h", "least hours90 >= 2650 h"},
     AS_MODELLED},
    {"BREEAM homes",
     BREEAM " (100 %): kitchens, living rooms, dining rooms, studies",
     {"hours100 of mean >= 3450 h", "least hours30 >= 3450 h"},
     AS_MODELLED},
    {"BREEAM communal rooms",
     BREEAM " (80 %): of homes",
     {"hours200 of mean >= 2650 h", "least hours60 >= 2650 h"},
     AS_MODELLED},
    {"BREEAM sales areas",
     BREEAM " (35 %)",
     {"hours200 of mean >= 2650 h", "least hours200 >= 2650 h"},
     AS_MODELLED},
    {"BREEAM retail, other rooms",
     BREEAM " (80 %)",
     {"hours200 of mean >= 2650 h", "least hours60 >= 2650 h"},
     AS_MODELLED},
    {"BREEAM other buildings",
     BREEAM " (80 %)",
     {"hours300 of mean >= 2000 h", "least hours90 >= 2000 h"},
     AS_MODELLED},
};

enum { RULES = sizeof rules / sizeof *rules };

int orl_annual_rules_find(const char *name, const struct orl_annual_rule **ret_first,
                          size_t *ret_count, struct orl_error *err)
{
    const size_t length = strlen(name);
    size_t first = 0, count = 0;
    while (first < RULES && strncasecmp(rules[first].name, name, length) != 0)
        first++;
    while (first + count < RULES && strncasecmp(rules[first + count].name, name, length) == 0)
        count++;
    if (count == 0 || length == 0) {
        orl_error_set(err, ORL_ERR_NOT_FOUND, "there are no rules named '%s'", name);
        orl_error_hint(err, "there are \"EN 17037\", \"LEED\", \"WELL L01\", \"WELL L06\", "
                            "\"BREEAM offices\", ..., and longer names for single rules");
        return ORL_ERR_NOT_FOUND;
    }
    *ret_first = &rules[first];
    *ret_count = count;
    return 0;
}
