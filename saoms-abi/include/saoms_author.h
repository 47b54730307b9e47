/* What makes components in C short to write: texts, failures, lines of the log, properties, and CDR, the byte form of messages.
 *
 * Everything here is `static inline` and rests on `saoms.h` alone; a library in C can do without it.
 */

#ifndef SAOMS_AUTHOR_H
#define SAOMS_AUTHOR_H

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "saoms.h"

/* Texts. */

// A text that ends with a zero.
static inline SaomsBytes saoms_text(const char *text) {
    SaomsBytes bytes;
    bytes.data = (const uint8_t *)text;
    bytes.length = strlen(text);
    return bytes;
}

// Whether bytes are this text.
static inline int saoms_is(SaomsBytes bytes, const char *text) {
    size_t length = strlen(text);
    return bytes.length == length && (length == 0 || memcmp(bytes.data, text, length) == 0);
}

// A failure with what went wrong: `return saoms_fail(error, "found no ID");`.
static inline SaomsStatus saoms_fail(SaomsSink error, const char *message) {
    error.put(error.state, saoms_text(message));
    return SaomsStatus_FAILED;
}

// The levels of the log.
#define SAOMS_ERROR 0
#define SAOMS_WARNING 1
#define SAOMS_INFO 2
#define SAOMS_DEBUG 3

// Writes a line to the log, as `printf`, where somebody reads it; at most 511 bytes.
static inline void saoms_log(const SaomsHostHandle *host, uint32_t level, const char *format, ...) {
    char line[512];
    va_list arguments;
    if (host->functions->listens(host->state, level) == 0) {
        return;
    }
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    host->functions->log(host->state, level, saoms_text(line));
}

/* Properties. */

// The value that a composite gives to a property; null where it gives none, so that the default counts.
static inline const SaomsPropertyView *saoms_property(const SaomsPropertyView *values, size_t count, const char *name) {
    size_t place;
    for (place = 0; place < count; place++) {
        if (saoms_is(values[place].name, name)) {
            return &values[place];
        }
    }
    return NULL;
}

// The same as a number, or `otherwise`. The checker has held the text to the declaration before.
static inline double saoms_property_number(
    const SaomsPropertyView *values, size_t count, const char *name, double otherwise) {
    const SaomsPropertyView *value = saoms_property(values, count, name);
    char text[64];
    if (value == NULL || value->kind != 0 || value->text.length == 0 || value->text.length >= sizeof text) {
        return otherwise;
    }
    memcpy(text, value->text.data, value->text.length);
    text[value->text.length] = 0;
    return strtod(text, NULL);
}

// The same as a text that ends with a zero, cut off where the buffer ends; an empty one where the composite gives none.
static inline void saoms_property_text(
    const SaomsPropertyView *values, size_t count, const char *name, char *buffer, size_t capacity) {
    const SaomsPropertyView *value = saoms_property(values, count, name);
    size_t length = value == NULL || value->kind != 0 ? 0 : value->text.length;
    if (length >= capacity) {
        length = capacity - 1;
    }
    if (length > 0) {
        memcpy(buffer, value->text.data, length);
    }
    buffer[length] = 0;
}

// Refuses a property of the component that is being made: the checker shows this at the property in the composite.
static inline SaomsStatus saoms_refuse(
    SaomsFindingSink findings, SaomsSink error, const char *property, const char *message) {
    SaomsFindingView finding;
    memset(&finding, 0, sizeof finding);
    finding.place.component = SIZE_MAX;
    finding.place.property = saoms_text(property);
    finding.message = saoms_text(message);
    findings.put(findings.state, &finding);
    return saoms_fail(error, message);
}

/* What is put into a sink, in memory of one's own. */

// Memory that a sink fills.
typedef struct SaomsBuffer {
    uint8_t *bytes;
    size_t capacity;
    // How much of it is filled.
    size_t length;
    // 1 if more was put than it holds; that is lost.
    int is_full;
} SaomsBuffer;

static inline SaomsBuffer saoms_buffer(void *bytes, size_t capacity) {
    SaomsBuffer buffer;
    buffer.bytes = (uint8_t *)bytes;
    buffer.capacity = capacity;
    buffer.length = 0;
    buffer.is_full = 0;
    return buffer;
}

static inline void saoms_buffer_put(void *state, SaomsBytes bytes) {
    SaomsBuffer *buffer = (SaomsBuffer *)state;
    size_t length = bytes.length;
    if (length > buffer->capacity - buffer->length) {
        length = buffer->capacity - buffer->length;
        buffer->is_full = 1;
    }
    if (length > 0) {
        memcpy(buffer->bytes + buffer->length, bytes.data, length);
        buffer->length += length;
    }
}

// A sink into a buffer, which has to outlive the call that it is given to.
static inline SaomsSink saoms_sink(SaomsBuffer *buffer) {
    SaomsSink sink;
    sink.state = buffer;
    sink.put = saoms_buffer_put;
    return sink;
}

// What a buffer holds.
static inline SaomsBytes saoms_bytes(const SaomsBuffer *buffer) {
    SaomsBytes bytes;
    bytes.data = buffer->bytes;
    bytes.length = buffer->length;
    return bytes;
}

/* CDR: a header of four bytes, then the fields in their order; numbers in little endian, at their alignment. A nested message is its
 * fields, an array its elements, an enumeration the number of its constant, a sequence the number of its elements (`u32`) and these. */

// A buffer that holds the header, to write a message into.
static inline SaomsBuffer saoms_writer(void *bytes, size_t capacity) {
    static const uint8_t header[4] = {0, 1, 0, 0};
    SaomsBuffer buffer = saoms_buffer(bytes, capacity);
    SaomsBytes start;
    start.data = header;
    start.length = sizeof header;
    saoms_buffer_put(&buffer, start);
    return buffer;
}

static inline void saoms_write_number(SaomsBuffer *buffer, uint64_t value, size_t size) {
    uint8_t bytes[16] = {0};
    SaomsBytes all;
    size_t padding = (4 - buffer->length) & (size - 1);
    size_t at;
    for (at = 0; at < size; at++) {
        bytes[padding + at] = (uint8_t)(value >> (8 * at));
    }
    all.data = bytes;
    all.length = padding + size;
    saoms_buffer_put(buffer, all);
}

static inline void saoms_write_bool(SaomsBuffer *buffer, int value) { saoms_write_number(buffer, value != 0, 1); }
static inline void saoms_write_u8(SaomsBuffer *buffer, uint8_t value) { saoms_write_number(buffer, value, 1); }
static inline void saoms_write_u16(SaomsBuffer *buffer, uint16_t value) { saoms_write_number(buffer, value, 2); }
static inline void saoms_write_u32(SaomsBuffer *buffer, uint32_t value) { saoms_write_number(buffer, value, 4); }
static inline void saoms_write_u64(SaomsBuffer *buffer, uint64_t value) { saoms_write_number(buffer, value, 8); }
static inline void saoms_write_i32(SaomsBuffer *buffer, int32_t value) { saoms_write_u32(buffer, (uint32_t)value); }
static inline void saoms_write_i64(SaomsBuffer *buffer, int64_t value) { saoms_write_u64(buffer, (uint64_t)value); }

static inline void saoms_write_f64(SaomsBuffer *buffer, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    saoms_write_u64(buffer, bits);
}

static inline void saoms_write_f32(SaomsBuffer *buffer, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    saoms_write_u32(buffer, bits);
}

static inline void saoms_write_string(SaomsBuffer *buffer, const char *text) {
    SaomsBytes bytes = saoms_text(text);
    bytes.length++;
    saoms_write_u32(buffer, (uint32_t)bytes.length);
    saoms_buffer_put(buffer, bytes);
}

// The message, once all is written; one without fields is a zero byte. Look at `is_full` where it may not have fit.
static inline SaomsBytes saoms_written(SaomsBuffer *buffer) {
    if (buffer->length == 4) {
        saoms_write_u8(buffer, 0);
    }
    return saoms_bytes(buffer);
}

// What reads a message. Behind the end everything is 0, and `failed` is 1.
typedef struct SaomsReader {
    const uint8_t *bytes;
    size_t length;
    size_t at;
    // 1 if the bytes ended too early, or are none of CDR.
    int failed;
} SaomsReader;

static inline SaomsReader saoms_reader(SaomsBytes message) {
    SaomsReader reader;
    reader.bytes = message.data;
    reader.length = message.length;
    reader.at = 4;
    reader.failed = message.length < 4 || message.data[0] != 0 || message.data[1] != 1;
    return reader;
}

static inline uint64_t saoms_read_number(SaomsReader *reader, size_t size) {
    uint64_t value = 0;
    size_t start = reader->at + ((4 - reader->at) & (size - 1));
    size_t at;
    if (reader->failed || start + size > reader->length) {
        reader->failed = 1;
        return 0;
    }
    for (at = 0; at < size; at++) {
        value |= (uint64_t)reader->bytes[start + at] << (8 * at);
    }
    reader->at = start + size;
    return value;
}

static inline int saoms_read_bool(SaomsReader *reader) { return saoms_read_number(reader, 1) != 0; }
static inline uint8_t saoms_read_u8(SaomsReader *reader) { return (uint8_t)saoms_read_number(reader, 1); }
static inline uint16_t saoms_read_u16(SaomsReader *reader) { return (uint16_t)saoms_read_number(reader, 2); }
static inline uint32_t saoms_read_u32(SaomsReader *reader) { return (uint32_t)saoms_read_number(reader, 4); }
static inline uint64_t saoms_read_u64(SaomsReader *reader) { return saoms_read_number(reader, 8); }
static inline int32_t saoms_read_i32(SaomsReader *reader) { return (int32_t)saoms_read_u32(reader); }
static inline int64_t saoms_read_i64(SaomsReader *reader) { return (int64_t)saoms_read_u64(reader); }

static inline double saoms_read_f64(SaomsReader *reader) {
    uint64_t bits = saoms_read_u64(reader);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline float saoms_read_f32(SaomsReader *reader) {
    uint32_t bits = saoms_read_u32(reader);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

// A string, without the zero at its end; it lies in the message.
static inline SaomsBytes saoms_read_string(SaomsReader *reader) {
    SaomsBytes text = {NULL, 0};
    size_t length = saoms_read_u32(reader);
    if (reader->failed || length > reader->length - reader->at) {
        reader->failed = 1;
        return text;
    }
    if (length > 0) {
        text.data = reader->bytes + reader->at;
        text.length = length - 1;
        reader->at += length;
    }
    return text;
}

// The number of elements of a sequence; 0 where not even one byte for each is left.
static inline size_t saoms_read_count(SaomsReader *reader) {
    size_t count = saoms_read_u32(reader);
    if (reader->failed || count > reader->length - reader->at) {
        reader->failed = 1;
        return 0;
    }
    return count;
}

#endif /* SAOMS_AUTHOR_H */
