/* `wirebench export --to KIND`: a wire's law as input of another program. */
#ifndef WB_CLI_EXPORT_CARD_H
#define WB_CLI_EXPORT_CARD_H

/* Runs the command; returns an exit code. */
int wb_export_card(int argc, char **argv);

#endif
