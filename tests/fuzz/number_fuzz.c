/* number_fuzz.c - libFuzzer target: any bytes as a number. The value agrees with strtod, and is
 * the same after writing and reading it again.
 *
 *     clang -g -O1 -std=c11 -D_GNU_SOURCE -I. -fsanitize=fuzzer,address,undefined
 * tests/fuzz/number_fuzz.c proto/number*.c \ proto/powers.c -lm */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "proto/number.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool ok)
{
    if (!ok)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char dst[PROTO_NUMBER_MAX], *text = malloc(size + 1), *end;
    double v, back;
    uint32_t u;
    memcpy(text, data, size);
    text[size] = 0;
    double want = strtod(text, &end);
    bool read = proto_read_double((const char *)data, size, &v);
    if (read) {
        require(end == text + size);
        require(v == want || (want == 0 && fabs(v) == 0x1p-1074));
        if (isfinite(v)) {
            size_t n = proto_write_double(dst, v);
            require(proto_read_double(dst, n, &back) && memcmp(&v, &back, sizeof v) == 0);
        }
    } else if (size > 0 &&
               end == text + size) { /* forms that strtod accepts and the protocol does not */
        require(strpbrk(text, "xXnN \t\n\v\f\r") != NULL);
    }
    if (proto_read_u32((const char *)data, size, &u))
        require(read && v == u &&
                memcmp(dst, text, proto_write_u32(dst, u)) == 0 == (text[0] != '0' || u == 0));
    free(text);
    return 0;
}
