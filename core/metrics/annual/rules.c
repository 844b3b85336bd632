/* Requirements of standards and labels, as targets. */
#include <oriel/annual/annual_metrics.h>

#include <string.h>
#include <strings.h>

#include <oriel/base/suggest.h>

#define EN_17037 "EN 17037:2018, 5.1 and annex A, by climate data; half of the daylight hours"
#define EN_17037_DF                                                                                \
    "EN 17037:2018, 5.1 and annex A, by daylight factor; of the median diffuse illuminance"
#define LEED "LEED v4.1, EQ Daylight, option 1; blinds are as in the series"
#define WELL "WELL v2, Q2 2025"
#define BREEAM                                                                                     \
    "BREEAM Hea 01, illuminance averages; of each room, and credits by the area of rooms that "    \
    "pass"

/* A rule by its name, clause and targets. */
#define RULE(title, text, ...)                                                                     \
    {                                                                                              \
        .name = (title), .clause = (text), .targets = { __VA_ARGS__ }                              \
    }
/* A rule of LM-83's sDA for half of the hours of use, with blinds. */
#define LM_83(title, text, lux, share)                                                             \
    {                                                                                              \
        .name = (title), .clause = (text), .targets = {"sDA" #lux "/50 >= " #share " %"},          \
        .needs_blinds = true                                                                       \
    }
/* Targets of EN 17037 for a share of the area, by climate data and by daylight factor. */
#define DAYLIGHT_SDA(lux, share) "sDA" #lux "/50 in daylight hours >= " #share " %"
#define SDF(lux, share) "sDF" #lux "lx >= " #share " %"
/* Both targets of BREEAM: hours of the mean illuminance, and of the least. */
#define BREEAM_HOURS(mean, least, hours)                                                           \
    "hours" #mean " of mean >= " #hours " h", "least hours" #least " >= " #hours " h"

static const struct orl_annual_rule rules[] = {
    RULE("EN 17037 minimum", EN_17037, DAYLIGHT_SDA(300, 50), DAYLIGHT_SDA(100, 95)),
    RULE("EN 17037 medium", EN_17037, DAYLIGHT_SDA(500, 50), DAYLIGHT_SDA(300, 95)),
    RULE("EN 17037 high", EN_17037, DAYLIGHT_SDA(750, 50), DAYLIGHT_SDA(500, 95)),
    RULE("roof lights by EN 17037 minimum", EN_17037, DAYLIGHT_SDA(300, 95)),
    RULE("roof lights by EN 17037 medium", EN_17037, DAYLIGHT_SDA(500, 95)),
    RULE("roof lights by EN 17037 high", EN_17037, DAYLIGHT_SDA(750, 95)),
    RULE("daylight factor by EN 17037 minimum", EN_17037_DF, SDF(300, 50), SDF(100, 95)),
    RULE("daylight factor by EN 17037 medium", EN_17037_DF, SDF(500, 50), SDF(300, 95)),
    RULE("daylight factor by EN 17037 high", EN_17037_DF, SDF(750, 50), SDF(500, 95)),
    RULE("daylight factor of roof lights by EN 17037 minimum", EN_17037_DF, SDF(300, 95)),
    RULE("daylight factor of roof lights by EN 17037 medium", EN_17037_DF, SDF(500, 95)),
    RULE("daylight factor of roof lights by EN 17037 high", EN_17037_DF, SDF(750, 95)),
    LM_83("LEED v4.1, 1 point", LEED, 300, 40),
    LM_83("LEED v4.1, 2 points", LEED, 300, 55),
    LM_83("LEED v4.1, 3 points", LEED, 300, 75),
    RULE("LEED v4.1, annual sunlight exposure",
         LEED "; above it the design has to say how glare is met", "ASE1000,250 <= 10 %"),
    LM_83("WELL L01 by LM-83", WELL, 150, 30),
    RULE("WELL L01 by EN 17037", WELL, DAYLIGHT_SDA(200, 30)),
    LM_83("WELL L06 tier 1 by LM-83", WELL, 300, 55),
    RULE("WELL L06 tier 1 by EN 17037", WELL, DAYLIGHT_SDA(300, 50)),
    LM_83("WELL L06 tier 2 by LM-83", WELL, 300, 75),
    RULE("WELL L06 tier 2 by EN 17037", WELL, DAYLIGHT_SDA(300, 50), DAYLIGHT_SDA(100, 95)),
    RULE("BREEAM offices", BREEAM " (80 %)", BREEAM_HOURS(300, 90, 2000)),
    RULE("BREEAM education", BREEAM " (80 %; higher education 60 % for one credit)",
         BREEAM_HOURS(300, 90, 2000)),
    RULE("BREEAM healthcare, 1 credit", BREEAM " (80 %)", BREEAM_HOURS(300, 90, 2000)),
    RULE("BREEAM healthcare, 2 credits", BREEAM " (80 %)", BREEAM_HOURS(300, 90, 2650)),
    RULE("BREEAM homes", BREEAM " (100 %): kitchens, living rooms, dining rooms, studies",
         BREEAM_HOURS(100, 30, 3450)),
    RULE("BREEAM communal rooms", BREEAM " (80 %): of homes", BREEAM_HOURS(200, 60, 2650)),
    RULE("BREEAM sales areas", BREEAM " (35 %)", BREEAM_HOURS(200, 200, 2650)),
    RULE("BREEAM retail, other rooms", BREEAM " (80 %)", BREEAM_HOURS(200, 60, 2650)),
    RULE("BREEAM other buildings", BREEAM " (80 %)", BREEAM_HOURS(300, 90, 2000)),
};

enum { RULES = sizeof rules / sizeof *rules };

/* Suggests a family of rules, or else a single rule. */
static void hint_rule(const char *name, struct orl_error *err)
{
    static const char *const families[] = {"EN 17037", "LEED",     "daylight factor by EN 17037",
                                           "WELL L01", "WELL L06", "roof lights by EN 17037",
                                           "BREEAM"};
    struct orl_suggestion suggestion = {.word = name};
    for (size_t i = 0; i < sizeof families / sizeof *families; i++)
        orl_suggestion_add(&suggestion, families[i]);
    for (size_t i = 0; i < RULES; i++)
        orl_suggestion_add(&suggestion, rules[i].name);
    orl_suggestion_hint(&suggestion, err);
}

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
        hint_rule(name, err);
        return ORL_ERR_NOT_FOUND;
    }
    *ret_first = &rules[first];
    *ret_count = count;
    return 0;
}
