#include "tests/own_folder.h"

#include <dirent.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/hash.h"

static int set_up(void **state)
{
    wb_log_set_sink(discard_message, NULL);
    return make_folder(state);
}

static int tear_down(void **state)
{
    wb_log_set_sink(NULL, NULL);
    return remove_folder(state);
}

static int entries(const char *path)
{
    DIR *opened = opendir(path);
    int n = -2;
    while (opened && readdir(opened))
        n++;
    closedir(opened);
    return n;
}

static void written_bytes_read_back(void **state)
{
    (void)state;
    char path[WB_PATH], *bytes;
    size_t size;
    assert_int_equal(wb_file_join(path, folder, "a.bin"), WB_OK);
    char block[70000];
    for (size_t i = 0; i < sizeof block; i++)
        block[i] = (char)(i * 31);
    assert_int_equal(wb_file_write(path, block, sizeof block), WB_OK);
    assert_int_equal(wb_file_read(path, &bytes, &size), WB_OK);
    assert_int_equal(size, sizeof block);
    assert_memory_equal(bytes, block, size);
    assert_int_equal(bytes[size], 0);
    free(bytes);
    assert_int_equal(entries(folder), 1);
}

static void a_failed_write_keeps_the_old_file(void **state)
{
    (void)state;
    char path[WB_PATH], *bytes;
    assert_int_equal(wb_file_join(path, folder, "a.txt"), WB_OK);
    assert_int_equal(wb_file_write(path, "old", 3), WB_OK);

    struct rlimit before, small;
    getrlimit(RLIMIT_FSIZE, &before);
    small = (struct rlimit){1024, before.rlim_max};
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &small);
    static const char large[4096];
    const enum wb_status status = wb_file_write(path, large, sizeof large);
    setrlimit(RLIMIT_FSIZE, &before);

    assert_int_equal(status, WB_ERR_IO);
    assert_int_equal(wb_file_read(path, &bytes, NULL), WB_OK);
    assert_string_equal(bytes, "old");
    free(bytes);
    assert_int_equal(entries(folder), 1);
}

static void an_output_folder_with_files_needs_force(void **state)
{
    (void)state;
    char path[WB_PATH], inside[WB_PATH];
    assert_int_equal(wb_file_join(path, folder, "a/b/c"), WB_OK);
    assert_int_equal(wb_file_prepare_output(path, false), WB_OK);
    assert_int_equal(wb_file_prepare_output(path, false), WB_OK);
    assert_int_equal(wb_file_join(inside, path, "x"), WB_OK);
    assert_int_equal(wb_file_write(inside, "x", 1), WB_OK);
    assert_int_equal(wb_file_prepare_output(path, false), WB_ERR_EXISTS);
    assert_int_equal(wb_file_prepare_output(path, true), WB_OK);
    assert_int_equal(wb_file_prepare_output(inside, true), WB_ERR_EXISTS);
}

static void paths_are_split(void **state)
{
    (void)state;
    char part[WB_PATH];
    wb_file_folder(part, "a/b.yaml");
    assert_string_equal(part, "a");
    wb_file_folder(part, "b.yaml");
    assert_string_equal(part, ".");
    wb_file_folder(part, "/b.yaml");
    assert_string_equal(part, "/");
    assert_string_equal(wb_file_name("a/b.yaml"), "b.yaml");
    assert_int_equal(wb_file_join(part, "a", "/b"), WB_OK);
    assert_string_equal(part, "/b");
}

static void fixtures_are_found_by_name_and_by_path(void **state)
{
    (void)state;
    char path[WB_PATH], file[WB_PATH];
    assert_int_equal(wb_file_join(file, folder, "mine.yaml"), WB_OK);
    assert_int_equal(wb_file_write(file, "a: 1\n", 5), WB_OK);
    assert_int_equal(wb_file_find_fixture(path, "wires", "mine.yaml", folder), WB_OK);
    assert_string_equal(path, file);
    assert_int_equal(wb_file_find_fixture(path, "wires", file, NULL), WB_OK);
    assert_int_equal(wb_file_find_fixture(path, "wires", "no-such-wire", NULL), WB_ERR_NOT_FOUND);
    assert_int_equal(wb_file_find_fixture(path, "wires", "no/such.yaml", folder), WB_ERR_NOT_FOUND);
    /* A file without an extension. */
    assert_int_equal(wb_file_join(file, folder, "mine"), WB_OK);
    assert_int_equal(wb_file_write(file, "a: 1\n", 5), WB_OK);
    assert_int_equal(wb_file_find_fixture(path, "wires", "mine", folder), WB_OK);
    assert_string_equal(path, file);
    assert_int_equal(wb_file_find_fixture(path, "wires", "type1", folder), WB_OK);
    assert_non_null(strstr(path, "fixtures/wires/type1.yaml"));
    assert_int_equal(wb_file_join(file, folder, "results"), WB_OK);
    assert_int_equal(wb_file_make_folder(file), WB_OK);
    assert_int_equal(wb_file_find_fixture(path, "wires", "results", folder), WB_ERR_NOT_FOUND);
    /* Shipped data in the folder from the environment has precedence. */
    char shipped[WB_PATH];
    assert_int_equal(wb_file_join(shipped, folder, "fixtures/wires"), WB_OK);
    assert_int_equal(wb_file_make_folder(shipped), WB_OK);
    assert_int_equal(wb_file_join(shipped, folder, "fixtures/wires/special.yaml"), WB_OK);
    assert_int_equal(wb_file_write(shipped, "a: 1\n", 5), WB_OK);
    setenv("WIREBENCH_DATA", folder, 1);
    assert_int_equal(wb_file_find_fixture(path, "wires", "special", NULL), WB_OK);
    unsetenv("WIREBENCH_DATA");
    assert_string_equal(path, shipped);
}

static char last_message[2048];

static void remember(void *context, enum wb_log_level level, const char *domain,
                     const char *message)
{
    (void)context, (void)level, (void)domain;
    snprintf(last_message, sizeof last_message, "%s", message);
}

static void unknown_name_is_reported_with_its_place(void **state)
{
    (void)state;
    char path[WB_PATH];
    wb_log_set_sink(remember, NULL);
    assert_int_equal(wb_file_find_named(path, "wires", "type9", NULL, "s.yaml:3: wire", NULL),
                     WB_ERR_NOT_FOUND);
    assert_ptr_equal(strstr(last_message, "s.yaml:3: wire: no 'type9'"), last_message);
    assert_int_equal(wb_file_find_named(path, "wires", "my.yaml", "/no", "s.yaml:3: wire", NULL),
                     WB_ERR_NOT_FOUND);
    assert_string_equal(last_message, "s.yaml:3: wire: no file 'my.yaml', here or in '/no'");
    wb_log_set_sink(discard_message, NULL);
}

static void a_lock_is_held_once_and_ends_with_its_holder(void **state)
{
    (void)state;
    char path[WB_PATH];
    struct wb_file_lock lock, second;
    long holder = -1;
    assert_int_equal(wb_file_join(path, folder, "test.lock"), WB_OK);
    /* A leftover lock file with a number. */
    assert_int_equal(wb_file_write(path, "123456789\n", 10), WB_OK);
    assert_int_equal(wb_file_lock(&lock, path, &holder), WB_OK);
    assert_int_equal(wb_file_lock(&second, path, &holder), WB_ERR_BUSY);
    assert_int_equal(holder, getpid());
    wb_file_unlock(&lock);
    assert_false(wb_file_exists(path));
    assert_int_equal(wb_file_lock(&lock, path, &holder), WB_OK);
    wb_file_unlock(&lock);
    assert_int_equal(wb_file_lock(&lock, "/no/such/folder/lock", &holder), WB_ERR_NOT_FOUND);
}

static void sha256_matches_the_standard_vector(void **state)
{
    (void)state;
    char hex[WB_SHA256_TEXT], path[WB_PATH];
    wb_hash_bytes("abc", 3, hex); /* FIPS 180-2, appendix B.1 */
    static const char expected[] =
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_string_equal(hex, expected);
    assert_int_equal(wb_file_join(path, folder, "abc"), WB_OK);
    assert_int_equal(wb_file_write(path, "abc", 3), WB_OK);
    assert_int_equal(wb_hash_file(path, hex), WB_OK);
    assert_string_equal(hex, expected);
    assert_int_equal(wb_hash_file("/no/such", hex), WB_ERR_NOT_FOUND);
}

#define fact(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        fact(written_bytes_read_back),
        fact(a_failed_write_keeps_the_old_file),
        fact(an_output_folder_with_files_needs_force),
        fact(paths_are_split),
        fact(fixtures_are_found_by_name_and_by_path),
        fact(unknown_name_is_reported_with_its_place),
        fact(a_lock_is_held_once_and_ends_with_its_holder),
        fact(sha256_matches_the_standard_vector),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
