/* What may come next on a command line, for the completion of shells (cli/completion/).
 *
 * `wirebench --complete WORD...` takes the words after `wirebench`, of which the last is being
 * typed and may be empty, and prints one candidate a line: the word, a tab, what it does. An option
 * that takes a value ends in '='. Nothing is printed where a file is wanted. The command runs as
 * usual up to wb_command_parse(), which prints the options that it would have taken, and ends:
 * there is no table but those of commands and settings.
 */
#ifndef WB_CLI_COMPLETE_H
#define WB_CLI_COMPLETE_H

#include <argp.h>
#include <stdbool.h>

/* From now on options are printed, not parsed. `word` is being typed, `before` stands before it;
 * both are borrowed. */
void wb_complete_begin(const char *word, const char *before);

bool wb_complete_is_on(void);

/* A word that may stand as the value of a long option. This and the next two are called before the
 * options are parsed, and do nothing unless completion is on. */
void wb_complete_value(const char *option, const char *word);

/* Words (NULL-terminated, borrowed) that may stand as an argument. */
void wb_complete_arguments(const char *const *words);

/* What ships in fixtures/KIND may stand as an argument, by its name; `kind` is borrowed. */
void wb_complete_shipped(const char *kind);

/* Prints `word` with what it does, where it begins like the word that is being typed. */
void wb_complete_print(const char *word, const char *what);

/* Prints the arguments that may stand there and, unless NULL, the options of `argp` and its
 * children. */
void wb_complete_finish(const struct argp *argp);

#endif
