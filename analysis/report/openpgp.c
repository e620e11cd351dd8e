#include "analysis/report/openpgp.h"

#include <stdio.h>
#include <string.h>

#include "base/program.h"

#define WB_LOG_DOMAIN "sign"

/* s; a person may have to type a passphrase. */
static const double answer_time = 300.0;

static enum wb_status run_gpg(struct wb_program_answer *answer, const char *const *words)
{
    const enum wb_status status = wb_program_run(answer, words, answer_time);
    return status == WB_ERR_NOT_FOUND
               ? wb_fail(status, "gpg is not installed (Debian: gnupg); signatures need it")
               : status;
}

/* The last line of gpg's output, which gives the reason. */
static const char *reason_of(const struct wb_program_answer *answer, char text[300])
{
    const char *all = wb_text_string(&answer->err), *line = all;
    size_t n = strlen(all);
    while (n > 0 && all[n - 1] == '\n')
        n--;
    for (size_t i = 0; i < n; i++)
        line = all[i] == '\n' ? all + i + 1 : line;
    snprintf(text, 300, "%.*s", (int)(n - (size_t)(line - all)), line);
    return text;
}

enum wb_status wb_openpgp_find_key(const char *key)
{
    const char *const words[] = {"gpg", "--batch", "--list-secret-keys", "--", key, NULL};
    struct wb_program_answer answer;
    WB_TRY(run_gpg(&answer, words));
    const bool is_there = answer.code == 0;
    wb_program_answer_release(&answer);
    return is_there ? WB_OK
                    : wb_fail(WB_ERR_NOT_FOUND,
                              "gpg has no secret key '%s'; `gpg --list-secret-keys` lists those it "
                              "has, `gpg --gen-key` makes one",
                              key);
}

enum wb_status wb_openpgp_sign(const char *path, const char *signature, const char *key)
{
    const char *const words[] = {"gpg",     "--batch",  "--yes",   "--local-user",  key,
                                 "--armor", "--output", signature, "--detach-sign", "--",
                                 path,      NULL};
    struct wb_program_answer answer;
    char why[300];
    enum wb_status status = WB_OK;
    WB_TRY(run_gpg(&answer, words));
    if (answer.code != 0)
        status = wb_fail(WB_ERR_IO, "gpg did not sign '%s': %s", path, reason_of(&answer, why));
    wb_program_answer_release(&answer);
    return status;
}

/* The rest of gpg's status line after a keyword ("[GNUPG:] GOODSIG ..."); NULL: no such line. */
static const char *find_status(const struct wb_program_answer *answer, const char *keyword)
{
    static const char head[] = "[GNUPG:] ";
    const size_t n = strlen(keyword);
    for (const char *line = wb_text_string(&answer->out); *line;) {
        if (strncmp(line, head, strlen(head)) == 0 &&
            strncmp(line + strlen(head), keyword, n) == 0) {
            const char *const rest = line + strlen(head) + n;
            if (*rest == ' ' || *rest == '\n' || *rest == '\0')
                return rest + (*rest == ' ');
        }
        line += strcspn(line, "\n");
        line += *line == '\n';
    }
    return NULL;
}

/* Words `from` to the end of the line, or one word alone. */
static void copy_words(char *text, size_t size, const char *words, int from, bool one)
{
    for (; from > 0; from--) {
        words += strcspn(words, " \n");
        words += *words == ' ';
    }
    snprintf(text, size, "%.*s", (int)strcspn(words, one ? " \n" : "\n"), words);
}

static enum wb_status judge(const struct wb_program_answer *answer, const char *path,
                            struct wb_openpgp_signer *signer)
{
    char why[300];
    const char *const good = find_status(answer, "GOODSIG");
    const char *const valid = find_status(answer, "VALIDSIG");
    const char *const unknown = find_status(answer, "NO_PUBKEY");
    if (unknown) {
        copy_words(why, sizeof why, unknown, 0, true);
        return wb_fail(WB_ERR_NOT_FOUND,
                       "the public key %s that signed '%s' is not here: get it from the laboratory "
                       "and `gpg --import` it",
                       why, path);
    }
    if (find_status(answer, "BADSIG"))
        return wb_fail(WB_ERR_DATA, "the signature is not of this '%s': it was altered", path);
    if (answer->code != 0 || !good || !valid)
        return wb_fail(WB_ERR_DATA, "no good signature of '%s': %s", path, reason_of(answer, why));
    copy_words(signer->name, sizeof signer->name, good, 1, false);
    copy_words(signer->fingerprint, sizeof signer->fingerprint, valid, 0, true);
    signer->is_trusted =
        find_status(answer, "TRUST_ULTIMATE") || find_status(answer, "TRUST_FULLY");
    return WB_OK;
}

enum wb_status wb_openpgp_verify(const char *path, const char *signature,
                                 struct wb_openpgp_signer *signer)
{
    const char *const words[] = {"gpg", "--batch", "--status-fd", "1", "--verify",
                                 "--",  signature, path,          NULL};
    struct wb_program_answer answer;
    WB_TRY(run_gpg(&answer, words));
    const enum wb_status status = judge(&answer, path, signer);
    wb_program_answer_release(&answer);
    return status;
}
