#include "cli/complete.h"

#include <glob.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"

static struct {
    bool is_on;
    const char *word, *before;
    const char *const *arguments;
    const char *kind; /* folder of fixtures/ */
} line;

void wb_complete_begin(const char *word, const char *before)
{
    line.is_on = true;
    line.word = word;
    line.before = before;
}

bool wb_complete_is_on(void)
{
    return line.is_on;
}

/* Whether the word is "--NAME=..." */
static bool is_joined(const char *name)
{
    const size_t n = strlen(name);
    return strncmp(line.word, "--", 2) == 0 && strncmp(line.word + 2, name, n) == 0 &&
           line.word[2 + n] == '=';
}

/* Whether the word before is "--NAME". */
static bool is_behind(const char *name)
{
    return strncmp(line.before, "--", 2) == 0 && strcmp(line.before + 2, name) == 0;
}

void wb_complete_print(const char *word, const char *what)
{
    if (strncmp(word, line.word, strlen(line.word)) == 0)
        printf("%s\t%s\n", word, what);
}

void wb_complete_value(const char *option, const char *word)
{
    char joined[128];
    if (!line.is_on)
        return;
    snprintf(joined, sizeof joined, "--%s=%s", option, word);
    if (is_joined(option))
        wb_complete_print(joined, "");
    else if (is_behind(option))
        wb_complete_print(word, "");
}

void wb_complete_arguments(const char *const *words)
{
    line.arguments = words;
}

void wb_complete_shipped(const char *kind)
{
    line.kind = kind;
}

/* Names of the files of a folder of fixtures. */
static void print_shipped(const char *kind)
{
    char name[64], folder[WB_PATH], pattern[WB_PATH];
    glob_t found;
    snprintf(name, sizeof name, "fixtures/%s", kind);
    if (wb_file_find_data(folder, name) != WB_OK ||
        wb_file_join(pattern, folder, "*.yaml") != WB_OK || glob(pattern, 0, NULL, &found) != 0)
        return;
    for (size_t i = 0; i < found.gl_pathc; i++) {
        char *const file = (char *)wb_file_name(found.gl_pathv[i]);
        file[strlen(file) - strlen(".yaml")] = '\0';
        wb_complete_print(file, "shipped");
    }
    globfree(&found);
}

static bool is_end(const struct argp_option *option)
{
    return !option->name && !option->key && !option->doc && !option->group;
}

/* Whether the word is the value of an option. */
static bool takes_value(const struct argp *argp)
{
    for (const struct argp_option *o = argp->options; o && !is_end(o); o++) {
        const char letter[] = {'-', (char)o->key, '\0'};
        if (!o->name || !o->arg)
            continue;
        if (is_joined(o->name) || is_behind(o->name) ||
            (o->key > ' ' && o->key < 127 && strcmp(line.before, letter) == 0))
            return true;
    }
    for (const struct argp_child *child = argp->children; child && child->argp; child++)
        if (takes_value(child->argp))
            return true;
    return false;
}

static void print_options(const struct argp *argp)
{
    for (const struct argp_option *o = argp->options; o && !is_end(o); o++) {
        char word[64];
        if (!o->name || (o->flags & OPTION_HIDDEN) != 0)
            continue;
        snprintf(word, sizeof word, "--%s%s", o->name, o->arg ? "=" : "");
        wb_complete_print(word, o->doc ? o->doc : "");
    }
    for (const struct argp_child *child = argp->children; child && child->argp; child++)
        print_options(child->argp);
}

void wb_complete_finish(const struct argp *argp)
{
    /* Known values are printed already. */
    if (argp && takes_value(argp))
        return;
    if (argp && line.word[0] == '-')
        print_options(argp);
    for (const char *const *word = line.arguments; word && *word; word++)
        wb_complete_print(*word, "");
    if (line.kind)
        print_shipped(line.kind);
}
