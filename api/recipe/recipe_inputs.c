/* Checks the inputs of a recipe. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/suggest.h>

#include "recipe/recipe.h"
#include "json/decode.h"

enum { NAME_SIZE = 64 };

const char *orl_recipe_text(const json_t *inputs, const char *name)
{
    return json_string_value(json_object_get(inputs, name));
}

double orl_recipe_number(const json_t *inputs, const char *name)
{
    const json_t *value = json_object_get(inputs, name);
    return json_is_number(value) ? json_number_value(value) : NAN;
}

const char *orl_recipe_weather(const json_t *inputs)
{
    const char *wea = orl_recipe_text(inputs, "wea");
    return wea ? wea : orl_recipe_text(inputs, "epw");
}

/* Copies a name with '-' for '_'. */
static void normalise(const char *name, char ret_name[NAME_SIZE])
{
    snprintf(ret_name, NAME_SIZE, "%s", name);
    for (char *at = ret_name; *at; at++)
        if (*at == '_')
            *at = '-';
}

static const struct orl_recipe_input *find_input(const struct orl_recipe *recipe, const char *given,
                                                 struct orl_error *err)
{
    struct orl_suggestion nearest = {.word = NULL};
    char name[NAME_SIZE];
    normalise(given, name);
    nearest.word = name;
    for (size_t i = 0; i < ORL_RECIPE_MOST_INPUTS && recipe->inputs[i].name; i++) {
        if (strcmp(recipe->inputs[i].name, name) == 0)
            return &recipe->inputs[i];
        orl_suggestion_add(&nearest, recipe->inputs[i].name);
    }
    orl_error_set(err, ORL_ERR_INVALID, "the recipe %s has no input '%.100s'", recipe->name, given);
    if (nearest.best)
        orl_error_hint(err, "did you mean %s?", nearest.best);
    else
        orl_error_hint(err, "`oriel recipe %s --help` lists the inputs", recipe->name);
    return NULL;
}

/* Reads a number from JSON, or from text as on a command line. */
static int read_number(const struct orl_recipe_input *input, const json_t *value,
                       json_t **ret_value, struct orl_error *err)
{
    const char *text = json_string_value(value);
    char *end = NULL;
    const double number = text ? strtod(text, &end) : json_number_value(value);
    const bool is_number = text ? end != text && *end == '\0' : json_is_number(value);
    if (!is_number || !isfinite(number) ||
        (input->type == ORL_INPUT_WHOLE && number != floor(number)))
        return orl_json_fail(err, ORL_ERR_INVALID, input->name, "a %s is expected",
                             input->type == ORL_INPUT_WHOLE ? "whole number" : "number");
    if (number < input->least || number > input->most)
        return orl_json_fail(err, ORL_ERR_RANGE, input->name, "it is from %.10g to %.10g",
                             input->least, input->most);
    *ret_value =
        input->type == ORL_INPUT_WHOLE ? json_integer((json_int_t)number) : json_real(number);
    return 0;
}

/* Returns true if words, separated by '|', has the word. */
static bool has_word(const char *words, const char *word)
{
    const size_t length = strlen(word);
    for (const char *at = words; at; at = strchr(at, '|') ? strchr(at, '|') + 1 : NULL)
        if (strncmp(at, word, length) == 0 && (at[length] == '|' || at[length] == '\0'))
            return true;
    return false;
}

static int read_text(const struct orl_recipe_input *input, json_t *value, json_t **ret_value,
                     struct orl_error *err)
{
    const char *text = json_string_value(value);
    if (!text || !*text)
        return orl_json_wrong_type(value, input->name, "a text", err);
    if (input->type == ORL_INPUT_WORD && !has_word(input->words, text))
        return orl_json_fail(err, ORL_ERR_INVALID, input->name, "'%.100s' is none of %s", text,
                             input->words);
    *ret_value = json_incref(value);
    return 0;
}

static int read_value(const struct orl_recipe_input *input, json_t *value, json_t *inputs,
                      json_t *notes, struct orl_error *err)
{
    json_t *read = NULL;
    int rc = 0;
    if (input->type == ORL_INPUT_TUNING)
        return json_array_append_new(notes, json_string(input->help)) ? orl_error_no_memory(err)
                                                                      : 0;
    if (input->type == ORL_INPUT_NUMBER || input->type == ORL_INPUT_WHOLE)
        rc = read_number(input, value, &read, err);
    else
        rc = read_text(input, value, &read, err);
    if (rc == 0 && json_object_set_new(inputs, input->name, read))
        rc = orl_error_no_memory(err);
    return rc;
}

static int complete(const struct orl_recipe *recipe, json_t *inputs, json_t *notes,
                    struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < ORL_RECIPE_MOST_INPUTS && recipe->inputs[i].name && rc == 0; i++) {
        const struct orl_recipe_input *input = &recipe->inputs[i];
        if (json_object_get(inputs, input->name))
            continue;
        if (input->is_required) {
            orl_error_set(err, ORL_ERR_INVALID, "the recipe %s needs the input '%s'", recipe->name,
                          input->name);
            orl_error_hint(err, "%s: %s", input->name, input->help);
            return ORL_ERR_INVALID;
        }
        json_t *value = input->value ? json_string(input->value) : NULL;
        if (value)
            rc = read_value(input, value, inputs, notes, err);
        json_decref(value);
    }
    return rc;
}

int orl_recipe_check_inputs(const struct orl_recipe *recipe, const json_t *given,
                            json_t **ret_inputs, json_t **ret_notes, struct orl_error *err)
{
    json_t *inputs = json_object(), *notes = json_array(), *value;
    const char *name;
    int rc = inputs && notes ? 0 : orl_error_no_memory(err);
    if (rc == 0 && !json_is_object(given))
        rc = orl_json_wrong_type(given, "inputs", "an object", err);
    json_object_foreach((json_t *)(uintptr_t)given, name, value)
    {
        if (rc || json_is_null(value))
            continue;
        const struct orl_recipe_input *input = find_input(recipe, name, err);
        rc = input ? read_value(input, value, inputs, notes, err) : ORL_ERR_INVALID;
    }
    if (rc == 0)
        rc = complete(recipe, inputs, notes, err);
    if (rc) {
        json_decref(inputs);
        json_decref(notes);
        return rc;
    }
    *ret_inputs = inputs;
    *ret_notes = notes;
    return 0;
}
