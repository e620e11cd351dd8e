#include "tests/check.h"

#include "base/memory.h"
#include "base/text.h"

static void text_grows_by_appending(void **state)
{
    (void)state;
    struct wb_text text = {0};
    assert_string_equal(wb_text_string(&text), "");
    for (int i = 0; i < 1000; i++)
        wb_text_append(&text, "%d,", i % 10);
    assert_int_equal(text.length, 2000);
    assert_int_equal(strlen(wb_text_string(&text)), 2000);
    assert_memory_equal(wb_text_string(&text), "0,1,2,", 6);
    wb_text_release(&text);
    assert_int_equal(text.length, 0);
}

static void markup_is_escaped(void **state)
{
    (void)state;
    struct wb_text text = {0};
    wb_text_append_escaped(&text, "a<b> & \"c\" 'd'");
    assert_string_equal(wb_text_string(&text), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
    wb_text_release(&text);
}

static enum wb_status append_an_invalid_size(void *text)
{
    wb_text_append_bytes(text, "x", SIZE_MAX);
    return WB_OK;
}

static void an_invalid_size_fails_as_an_allocation(void **state)
{
    (void)state;
    struct wb_text text = {0};
    wb_text_append(&text, "kept");
    wb_log_set_sink(discard_message, NULL);
    assert_int_equal(wb_memory_try(append_an_invalid_size, &text), WB_ERR_MEMORY);
    wb_log_set_sink(NULL, NULL);
    assert_string_equal(wb_text_string(&text), "kept");
    wb_text_release(&text);
}

static void words_are_quoted_for_the_shell(void **state)
{
    (void)state;
    struct wb_text text = {0};
    wb_text_append_quoted(&text, "data/type3-L85.yaml");
    wb_text_append_quoted(&text, "");
    wb_text_append_quoted(&text, "a wire's $x");
    assert_string_equal(wb_text_string(&text), "data/type3-L85.yaml'''a wire'\\''s $x'");
    wb_text_release(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_grows_by_appending),
        cmocka_unit_test(markup_is_escaped),
        cmocka_unit_test(words_are_quoted_for_the_shell),
        cmocka_unit_test(an_invalid_size_fails_as_an_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
