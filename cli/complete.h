/* Candidates for the next word of a command line, for the shells' completion (cli/completion/).
 *
 * The words of `wirebench --complete WORD...` are those behind `wirebench`, of which the last is
 * being typed and may be empty. It prints one candidate a line: the word, a tab, its description.
 * An option with a value ends in '='. Nothing is printed where a file is expected. The command runs
 * up to wb_command_parse(), which prints its options and exits, so that completion needs no table
 * of its own.
 */
#ifndef WB_CLI_COMPLETE_H
#define WB_CLI_COMPLETE_H

#include <argp.h>
#include <stdbool.h>

/* From now on options are printed, not parsed. `word` is being typed, `before` stands before it;
 * both are borrowed. */
void wb_complete_begin(const char *word, const char *before);

bool wb_complete_is_on(void);

/* Offers a value of a long option. This and the next two are called before the options are parsed,
 * and do nothing unless completion is on. */
void wb_complete_value(const char *option, const char *word);

/* Offers words (NULL-terminated, borrowed) as an argument. */
void wb_complete_arguments(const char *const *words);

/* Offers the names of the files in fixtures/KIND as an argument; `kind` is borrowed. */
void wb_complete_shipped(const char *kind);

/* Prints `word` and its description, if it begins like the word that is being typed. */
void wb_complete_print(const char *word, const char *what);

/* Prints the arguments that were offered and, unless NULL, the options of `argp` and its children.
 */
void wb_complete_finish(const struct argp *argp);

#endif
