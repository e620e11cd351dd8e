#include "base/program.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/timing.h"
#include "base/units.h"

#define WB_LOG_DOMAIN "program"

/* Finds a program in PATH. */
static bool find_program(char path[WB_PATH], const char *name)
{
    const char *folder = getenv("PATH");
    while (folder && *folder) {
        const size_t n = strcspn(folder, ":");
        if (snprintf(path, WB_PATH, "%.*s%s%s", (int)n, folder, n > 0 ? "/" : "", name) < WB_PATH &&
            access(path, X_OK) == 0 && !wb_file_is_folder(path))
            return true;
        folder += n + (folder[n] == ':');
    }
    return false;
}

/* Waits for the process; its exit code goes to *code. False if it had to be killed. */
static bool wait_for(pid_t child, double timeout, int *code)
{
    const int64_t until_ns = wb_time_now_ns() + wb_ns_from_seconds(timeout);
    int status = 0, ms = 1;
    bool killed = false;
    for (;;) {
        const pid_t ended = waitpid(child, &status, WNOHANG);
        if (ended == child || (ended < 0 && errno != EINTR))
            break;
        if (!killed && wb_time_now_ns() > until_ns) {
            kill(-child, SIGKILL);
            killed = true;
        }
        wb_time_sleep(wb_time_now_ns() + ms * WB_NS_PER_MS);
        ms = ms < 50 ? 2 * ms : 50;
    }
    *code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    return !killed;
}

static void read_back(struct wb_text *text, int descriptor)
{
    char bytes[4096];
    ssize_t n;
    if (lseek(descriptor, 0, SEEK_SET) != 0)
        return;
    while ((n = read(descriptor, bytes, sizeof bytes)) > 0)
        wb_text_append_bytes(text, bytes, (size_t)n);
}

/* Output goes to two files in memory, which cannot block like a pipe without a reader. */
static enum wb_status run_into(struct wb_program_answer *answer, const char *path,
                               const char *const *words, double timeout, const int files[2])
{
    const pid_t child = fork();
    if (child < 0)
        return wb_fail(WB_ERR_IO, "cannot start '%s': %s", path, strerror(errno));
    if (child == 0) {
        setpgid(0, 0); /* own process group: Ctrl-C must not interrupt a job submission */
        const int nothing = open("/dev/null", O_RDONLY);
        if (nothing >= 0 && dup2(nothing, STDIN_FILENO) >= 0 &&
            dup2(files[0], STDOUT_FILENO) >= 0 && dup2(files[1], STDERR_FILENO) >= 0)
            execv(path, (char *const *)words);
        _exit(127);
    }
    setpgid(child, child);
    if (!wait_for(child, timeout, &answer->code))
        return wb_fail(WB_ERR_TIMEOUT, "%s did not finish within %.0f s and was killed", words[0],
                       timeout);
    read_back(&answer->out, files[0]);
    read_back(&answer->err, files[1]);
    return WB_OK;
}

enum wb_status wb_program_run(struct wb_program_answer *answer, const char *const *words,
                              double timeout)
{
    char path[WB_PATH];
    *answer = (struct wb_program_answer){0};
    if (!find_program(path, words[0]))
        return WB_ERR_NOT_FOUND;
    const int files[2] = {memfd_create("out", MFD_CLOEXEC), memfd_create("err", MFD_CLOEXEC)};
    enum wb_status status = WB_OK;
    if (files[0] < 0 || files[1] < 0)
        status = wb_fail(WB_ERR_IO, "cannot create a file in memory: %s", strerror(errno));
    else
        status = run_into(answer, path, words, timeout, files);
    for (int i = 0; i < 2; i++)
        if (files[i] >= 0)
            close(files[i]);
    if (status != WB_OK)
        wb_program_answer_release(answer);
    return status;
}

void wb_program_answer_release(struct wb_program_answer *answer)
{
    wb_text_release(&answer->out);
    wb_text_release(&answer->err);
}
