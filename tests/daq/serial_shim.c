/* Preloaded into test_stream_serial: gives a pseudo-terminal the properties that libserialport
 * needs of a serial port, so that the real libserialport code runs without hardware. libserialport
 * 0.1 looks up /sys/class/tty/NAME (lstat, readlink, opendir), opens /dev/NAME and uses the modem
 * lines (TIOCMGET, TIOCMSET), which pseudo-terminals lack; they also know 8 bits without parity
 * only.
 *
 * The test steers it through the environment:
 *     WB_SHIM_SYSFS   folder that stands for /sys/class/tty
 *     WB_SHIM_PORT    path of the port that is lent, "/dev/ttyWB0"
 *     WB_SHIM_DEVICE  the pseudo-terminal behind it; unset: the port cannot be opened (ENOENT)
 *     WB_SHIM_ERRNO   opening the port fails with this error number
 * and asks through the functions below, found by dlsym().
 */
#undef _FILE_OFFSET_BITS /* else open() here would define open64() */
#undef _FORTIFY_SOURCE

#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/serial.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#define SYSFS "/sys/class/tty"

static int modem_lines = TIOCM_CTS | TIOCM_DSR | TIOCM_CAR;
static int serial_flags;
static int exclusive;        /* whether TIOCEXCL holds */
static tcflag_t frame = CS8; /* bits and parity as set */

int wb_shim_modem_lines(void);
int wb_shim_modem_lines(void)
{
    return modem_lines;
}

int wb_shim_serial_flags(void);
int wb_shim_serial_flags(void)
{
    return serial_flags;
}

int wb_shim_exclusive(void);
int wb_shim_exclusive(void)
{
    return exclusive;
}

int wb_shim_frame(void);
int wb_shim_frame(void)
{
    return (int)frame;
}

/* Sets a function pointer to the next definition of its symbol after this library. */
static void find_next(const char *name, void *function, size_t size)
{
    void *found = dlsym(RTLD_NEXT, name);
    memcpy(function, &found, size);
}

/* The real target of a path; NULL with errno set if the call must fail. */
static const char *lead(const char *path, char *space)
{
    const char *port = getenv("WB_SHIM_PORT"), *sysfs = getenv("WB_SHIM_SYSFS");
    if (port && strcmp(path, port) == 0) {
        const char *error = getenv("WB_SHIM_ERRNO");
        const char *device = getenv("WB_SHIM_DEVICE");
        errno = error ? atoi(error) : ENOENT;
        return error ? NULL : device;
    }
    if (sysfs && strncmp(path, SYSFS, strlen(SYSFS)) == 0) {
        snprintf(space, PATH_MAX, "%s%s", sysfs, path + strlen(SYSFS));
        return space;
    }
    return path;
}

static int open_led(const char *symbol, const char *path, int flags, mode_t mode)
{
    char space[PATH_MAX];
    int (*real)(const char *, int, ...);
    find_next(symbol, &real, sizeof real);
    const char *to = lead(path, space);
    return to ? real(to, flags, mode) : -1;
}

int open(const char *path, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    return open_led("open", path, flags, mode);
}

int open64(const char *path, int flags, ...)
{
    va_list arguments;
    va_start(arguments, flags);
    mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    return open_led("open64", path, flags, mode);
}

/* What open() becomes in a library built with fortification. */
int __open_2(const char *path, int flags);
int __open_2(const char *path, int flags)
{
    return open_led("open", path, flags, 0);
}

/* What lstat() becomes in a library built against glibc before 2.33. */
int __lxstat(int version, const char *path, struct stat *there);
int __lxstat(int version, const char *path, struct stat *there)
{
    char space[PATH_MAX];
    (void)version;
    const char *to = lead(path, space);
    return to ? fstatat(AT_FDCWD, to, there, AT_SYMLINK_NOFOLLOW) : -1;
}

int lstat(const char *path, struct stat *there)
{
    return __lxstat(0, path, there);
}

/* libserialport 0.1.2 asks where a port's name leads: to itself, where it is. */
static char *find_real(const char *path, char *resolved)
{
    char space[PATH_MAX];
    char *(*real)(const char *, char *);
    find_next("realpath", &real, sizeof real);
    const char *const port = getenv("WB_SHIM_PORT");
    if (!port || strcmp(path, port) != 0)
        return real(path, resolved);
    if (!lead(path, space) && errno == ENOENT)
        return NULL;
    return resolved ? strcpy(resolved, path) : strdup(path);
}

char *realpath(const char *path, char *resolved)
{
    return find_real(path, resolved);
}

/* What it becomes in a library built with fortification. */
char *__realpath_chk(const char *path, char *resolved, size_t size);
char *__realpath_chk(const char *path, char *resolved, size_t size)
{
    (void)size;
    return find_real(path, resolved);
}

ssize_t readlink(const char *path, char *target, size_t size)
{
    char space[PATH_MAX];
    const char *to = lead(path, space);
    return to ? readlinkat(AT_FDCWD, to, target, size) : -1;
}

DIR *opendir(const char *path)
{
    char space[PATH_MAX];
    DIR *(*real)(const char *);
    find_next("opendir", &real, sizeof real);
    const char *to = lead(path, space);
    return to ? real(to) : NULL;
}

FILE *fopen(const char *path, const char *mode)
{
    char space[PATH_MAX];
    FILE *(*real)(const char *, const char *);
    find_next("fopen", &real, sizeof real);
    const char *to = lead(path, space);
    return to ? real(to, mode) : NULL;
}

#define FRAME_BITS (tcflag_t)(CSIZE | PARENB | PARODD)

int tcgetattr(int descriptor, struct termios *settings)
{
    int (*real)(int, struct termios *);
    find_next("tcgetattr", &real, sizeof real);
    int result = real(descriptor, settings);
    if (result == 0)
        settings->c_cflag = (settings->c_cflag & ~FRAME_BITS) | frame;
    return result;
}

int tcsetattr(int descriptor, int when, const struct termios *settings)
{
    int (*real)(int, int, const struct termios *);
    find_next("tcsetattr", &real, sizeof real);
    struct termios possible = *settings;
    possible.c_cflag = (possible.c_cflag & ~FRAME_BITS) | CS8;
    int result = real(descriptor, when, &possible);
    if (result == 0)
        frame = settings->c_cflag & FRAME_BITS;
    return result;
}

/* The requests that a pseudo-terminal lacks. */
static int answer(unsigned long request, void *argument)
{
    int *bits = argument;
    struct serial_struct *serial = argument;
    switch (request) {
    case TIOCMGET:
        *bits = modem_lines;
        return 0;
    case TIOCMSET:
        modem_lines = *bits;
        return 0;
    case TIOCMBIS:
        modem_lines |= *bits;
        return 0;
    case TIOCMBIC:
        modem_lines &= ~*bits;
        return 0;
    case TIOCGSERIAL:
        memset(serial, 0, sizeof *serial);
        serial->flags = serial_flags;
        return 0;
    case TIOCSSERIAL:
        serial_flags = serial->flags;
        return 0;
    default:
        return -1;
    }
}

int ioctl(int descriptor, unsigned long request, ...)
{
    va_list arguments;
    va_start(arguments, request);
    void *argument = va_arg(arguments, void *);
    va_end(arguments);
    int (*real)(int, unsigned long, ...);
    find_next("ioctl", &real, sizeof real);
    int result = real(descriptor, request, argument);
    if (result == 0 && (request == TIOCEXCL || request == TIOCNXCL))
        exclusive = request == TIOCEXCL; /* libserialport 0.1.2 asks for it, too */
    if (result >= 0 || !getenv("WB_SHIM_DEVICE"))
        return result;
    int error = errno;
    if (answer(request, argument) == 0)
        return 0;
    errno = error;
    return result;
}
