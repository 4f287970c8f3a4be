/* The oracle's lines (spec/oracle.md) for an implementation in C, with jansson. An op is a function without arguments: it asks for
   what it needs by name, gives its answers by name, and may refuse. Nothing here knows what an op computes.

   Include it once, after a definition of REAL (float or double): every argument is rounded to it, every answer has been one. */
#include <jansson.h>
#include <math.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(list) (sizeof(list) / sizeof((list)[0]))

/* ---- The request in work ---- */

static struct {
    json_t *args, *ok;
    size_t asked, taken; /* arguments, numbers of memory */
    const char *code, *why;
    jmp_buf refused;
} call;
static REAL memory[1 << 22]; /* of the lists of one request */

static _Noreturn void refuse(const char *code, const char *why) {
    call.code = code;
    call.why = why;
    longjmp(call.refused, 1);
}

static REAL *take(size_t count) {
    if (count > COUNT(memory) - call.taken) refuse("failed", "out of memory");
    call.taken += count;
    return memory + call.taken - count;
}

/* ---- Arguments, and answers ---- */

static const json_t *argument(const char *name) {
    const json_t *value = json_object_get(call.args, name);
    if (value == NULL) refuse("bad_argument", "an argument is missing");
    call.asked++;
    return value;
}

static REAL real_of(const json_t *value) {
    if (!json_is_number(value)) refuse("bad_argument", "expected a number");
    REAL number = (REAL)json_number_value(value);
    if (!isfinite(number)) refuse("out_of_range", "the number is too large for this precision");
    return number;
}

static REAL number(const char *name) { return real_of(argument(name)); }

static REAL not_negative(const char *name) {
    REAL value = number(name);
    if (value < 0) refuse("out_of_range", "a number is below 0");
    return value;
}

static REAL positive(const char *name) {
    REAL value = number(name);
    if (value <= 0) refuse("out_of_range", "a number is not above 0");
    return value;
}

static REAL probability(const char *name) {
    REAL value = number(name);
    if (value <= 0 || value >= 1) refuse("out_of_range", "a probability is not between 0 and 1");
    return value;
}

typedef struct {
    size_t n;
    REAL *at;
} List;

static List list_of(const json_t *value) {
    if (!json_is_array(value)) refuse("bad_argument", "expected a list");
    size_t n = json_array_size(value);
    List list = {n, take(n)};
    for (size_t i = 0; i < n; i++) list.at[i] = real_of(json_array_get(value, i));
    return list;
}

static List list(const char *name) { return list_of(argument(name)); }

/* The record's or a template's channel, of as many samples as the other one. */
static List series(const char *name, size_t n) {
    List samples = list(name);
    if (n == 0 || samples.n != n) refuse("bad_argument", "no samples, or lists of unequal lengths");
    return samples;
}

/* Rows of equal lengths, one after the other. */
static const REAL *matrix(const char *name, size_t rows, size_t columns) {
    const json_t *value = argument(name);
    REAL *first = memory + call.taken;
    if (!json_is_array(value) || json_array_size(value) != rows) refuse("bad_argument", "expected another number of rows");
    for (size_t row = 0; row < rows; row++)
        if (list_of(json_array_get(value, row)).n != columns) refuse("bad_argument", "a row has another length");
    return first;
}

static const char *text(const char *name) {
    const json_t *value = argument(name);
    if (!json_is_string(value)) refuse("bad_argument", "expected a text");
    return json_string_value(value);
}

static int is(const char *one, const char *other) { return strcmp(one, other) == 0; }

static json_t *json_of(REAL value) {
    if (!isfinite(value)) refuse("overflow", "the answer is no finite number");
    return json_real((double)value);
}

static void give(const char *name, REAL value) { json_object_set_new(call.ok, name, json_of(value)); }

static void give_list(const char *name, List list) {
    json_t *array = json_array();
    json_object_set_new(call.ok, name, array);
    for (size_t i = 0; i < list.n; i++) json_array_append_new(array, json_of(list.at[i]));
}

static void give_whole(const char *name, size_t value) { json_object_set_new(call.ok, name, json_integer((json_int_t)value)); }

/* ---- Requests, and answers ---- */

typedef struct {
    const char *name;
    void (*answer)(void);
} Op;

static void answer(const char *op, const Op *ops, size_t count) {
    size_t i = 0;
    if (is(op, "capabilities")) {
        json_t *names = json_array();
        for (; i < count; i++) json_array_append_new(names, json_string(ops[i].name));
        json_object_set_new(call.ok, "version", json_sprintf("plain C, %u-bit numbers", (unsigned)(8 * sizeof(REAL))));
        json_object_set_new(call.ok, "ops", names);
        return;
    }
    while (i < count && !is(op, ops[i].name)) i++;
    if (i == count) refuse("unknown_op", "no such op");
    ops[i].answer();
    if (call.asked != json_object_size(call.args)) refuse("bad_argument", "an argument that the op does not have");
}

static void request(const json_t *line, const json_t *id, const Op *ops, size_t count) {
    const json_t *op = json_object_get(line, "op");
    call.args = json_object_get(line, "args");
    if (id == NULL || !json_is_string(op) || json_object_size(line) != (call.args == NULL ? 2 : 3))
        refuse("bad_request", "expected an object with id, op and args");
    if (call.args != NULL && !json_is_object(call.args)) refuse("bad_argument", "args is expected to be an object");
    answer(json_string_value(op), ops, count);
}

static json_t *reply_to(const json_t *line, const char *wrong, const Op *ops, size_t count) {
    json_t *const id = json_object_get(line, "id"), *const named = json_is_string(id) || json_is_number(id) ? id : NULL;
    if (setjmp(call.refused) != 0) return json_pack("{sO? s{ss ss}}", "id", named, "error", "code", call.code, "message", call.why);
    if (line == NULL) refuse("bad_json", wrong);
    request(line, named, ops, count);
    return json_pack("{sO? sO}", "id", named, "ok", call.ok);
}

/* Answers standard input until it ends. */
static void answer_lines(const Op *ops, size_t count) {
    char *line = NULL;
    size_t room = 0;
    for (ssize_t length; (length = getline(&line, &room, stdin)) >= 0;) {
        json_error_t wrong;
        json_t *parsed = json_loadb(line, (size_t)length, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, &wrong);
        call.asked = call.taken = 0;
        call.ok = json_object();
        json_t *reply = reply_to(parsed, wrong.text, ops, count);
        json_dumpf(reply, stdout, JSON_COMPACT | JSON_REAL_PRECISION(17));
        puts("");
        fflush(stdout);
        json_decref(reply);
        json_decref(call.ok);
        json_decref(parsed);
    }
    free(line);
}
