/* Any bytes are read as a table or rejected; all cells are within the table. Input: a byte of
 * settings, then the bytes of the file. */
#include "tests/fuzz.h"

#include <math.h>

#include "base/text_table.h"
#include "daq/take/table_columns.h"

static void read_columns(const struct wb_text_table *table, const char *list)
{
    struct wb_reason why = {{0}};
    struct wb_table_columns columns;
    if (wb_table_columns_find(&columns, table, list, 0, 9.81, "fuzz", &why) != WB_OK) {
        FUZZ_REQUIRE(why.text[0] != '\0');
        return;
    }
    for (int m = 0; m < WB_MEASURED_COUNT; m++) {
        FUZZ_REQUIRE(columns.column[m] >= -1 && columns.column[m] < table->n_columns);
        for (size_t row = 0; row < table->n_rows; row++) {
            double value;
            if (wb_table_columns_value(&columns, table, row, (enum wb_measured)m, &value, "fuzz",
                                       &why) == WB_OK)
                FUZZ_REQUIRE(!isinf(value));
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    static const char delimiters[] = {'\0', '\t', ';', ',', ' ', '|', '\0', '\0'};
    static const char decimals[] = {'\0', '.', ',', '\0'};
    struct wb_text_table table;
    struct wb_reason why = {{0}};
    if (n < 1)
        return 0;
    const struct wb_text_table_form form = {delimiters[bytes[0] & 7], decimals[bytes[0] >> 3 & 3]};
    if (wb_text_table_parse(&table, bytes + 1, n - 1, "fuzz", &form, &why) != WB_OK) {
        FUZZ_REQUIRE(why.text[0] != '\0');
        return 0;
    }
    FUZZ_REQUIRE(table.n_rows > 0 && table.n_columns > 0);
    FUZZ_REQUIRE(table.n_rows <= (size_t)table.n_lines);
    for (size_t row = 0; row < table.n_rows; row++)
        FUZZ_REQUIRE(table.lines[row] > table.header_line && table.lines[row] <= table.n_lines);
    read_columns(&table, NULL);
    read_columns(&table, "time=1:s,force=2:N,travel=3:mm");
    wb_text_table_release(&table);
    return 0;
}

#ifndef WB_LIBFUZZER

int main(int argc, char **argv)
{
    static const char *const texts[] = {
        "\x01Time (s)\tLoad (N)\tMachine Extension "
        "(mm)\r\n0.0\t\t\r\n0.1\t1.5\t\r\n0.2\t2.5\t0.3\r\n",
        "\x02Zeit;Kraft;Weg\ns;N;mm\n0,1;5,5;1e-3\n0,2;6,5;2e-3\n",
        "\x03\"Time, s\",\"Force, mN\",\"Stroke, mm\"\n\"0.1\",\"5\",\"1\"\n\"0.2\",\"6\",\"2\"\n",
        "\x04t_s force_N travel_mm\n0.1 5 1\n0.2 6 2\n0.3 NaN -\n",
        "\x01"
        "a\tb\n1\t1,234\n2\t2,345",
        "\x01Test;7\n\nTime;Load;State\n0.1;5;up\n0.2;6;up\r\r\n",
        "\x01\xef\xbb\xbfLoad (\xc2\xb5N)\tWay\n1\t2\n3\t4\n",
    };
    static const uint8_t utf16[] = "\x01\xff\xfeT\0\t\0F\0\n\0"
                                   "1\0\t\0"
                                   "2\0\n\0"
                                   "3\0\t\0"
                                   "4\0\n";
    const uint8_t *seeds[8];
    size_t sizes[8];
    for (size_t i = 0; i < 7; i++) {
        seeds[i] = (const uint8_t *)texts[i];
        sizes[i] = strlen(texts[i]);
    }
    seeds[7] = utf16;
    sizes[7] = sizeof utf16;
    return fuzz_main(argc, argv, seeds, sizes, 8, 100000);
}

#endif
