/* Writes what was given to it in CDR and reads that again: for the test `header`. */

#include "saoms_author.h"

/* Twice is no harm. */
#include "saoms_author.h"

static int fails(const char *what) {
    fprintf(stderr, "%s\n", what);
    return 1;
}

int main(void) {
    uint8_t memory[128];
    SaomsBuffer message = saoms_writer(memory, sizeof memory);
    SaomsReader reader;
    SaomsBytes text;
    size_t at;
    saoms_write_u8(&message, 7);
    saoms_write_i32(&message, -2);
    saoms_write_bool(&message, 1);
    saoms_write_f64(&message, 0.5);
    saoms_write_string(&message, "caf\xc3\xa9");
    saoms_write_u16(&message, 513);
    saoms_write_f32(&message, -1.25f);
    saoms_write_i64(&message, INT64_MIN);
    for (at = 0; at < message.length; at++) {
        printf("%02x", message.bytes[at]);
    }
    printf("\n");
    reader = saoms_reader(saoms_written(&message));
    if (saoms_read_u8(&reader) != 7 || saoms_read_i32(&reader) != -2 || !saoms_read_bool(&reader)) {
        return fails("the first three");
    }
    if (saoms_read_f64(&reader) != 0.5) {
        return fails("the number");
    }
    text = saoms_read_string(&reader);
    if (!saoms_is(text, "caf\xc3\xa9") || saoms_read_u16(&reader) != 513 || saoms_read_f32(&reader) != -1.25f) {
        return fails("the text and what is behind it");
    }
    if (saoms_read_i64(&reader) != INT64_MIN || reader.failed) {
        return fails("the last one");
    }
    if (saoms_read_u8(&reader) != 0 || !reader.failed) {
        return fails("behind the end");
    }
    /* No length of a message lets the reader leave it. */
    for (at = 0; at < message.length; at++) {
        SaomsBytes cut = saoms_bytes(&message);
        cut.length = at;
        reader = saoms_reader(cut);
        (void)saoms_read_u8(&reader);
        (void)saoms_read_u64(&reader);
        (void)saoms_read_u64(&reader);
        (void)saoms_read_string(&reader);
        (void)saoms_read_count(&reader);
        if (reader.at > at && !reader.failed) {
            return fails("a message that was cut off");
        }
    }
    /* A buffer that is too small holds what fits. */
    message = saoms_writer(memory, 6);
    saoms_write_u32(&message, 1);
    if (!message.is_full || message.length != 6) {
        return fails("a buffer that is too small");
    }
    return 0;
}
