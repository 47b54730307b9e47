/* Counts its executions. Built several times, with other values of BUILD and one of the words below, for what a new build can be like. */

#include <stdlib.h>
#include <unistd.h>

#include "saoms_author.h"

#ifndef DOC
#define DOC "Counts."
#endif

typedef struct Counter {
    uint64_t count;
} Counter;

static SaomsStatus counter_construct(const SaomsPropertyView *values, size_t count, void **made,
                                     SaomsFindingSink findings, SaomsSink error) {
    (void)values, (void)count, (void)findings, (void)error;
#ifdef REFUSES
    return saoms_fail(error, "this build refuses everything");
#endif
    *made = calloc(1, sizeof(Counter));
    return *made == NULL ? saoms_fail(error, "there is no memory left") : SaomsStatus_OK;
}

#ifdef HANGS_WHILE_LOADED
__attribute__((constructor)) static void hang(void) {
    for (;;) {
        sleep(1);
    }
}
#endif

#ifdef MOTOR
static SaomsStatus motor_stop(void *state, SaomsSink error) {
    static const char line[] = "the hardware stops\n";
    (void)state;
    return write(STDERR_FILENO, line, sizeof line - 1) < 0 ? saoms_fail(error, "nobody hears it") : SaomsStatus_OK;
}

static void motor_release(void *state) {
    (void)state;
    for (;;) {
        sleep(1);
    }
}
#define STOPS "true"
#else
#define STOPS "false"
#endif

static SaomsStatus counter_initialize(void *component, const SaomsHostHandle *host, SaomsSink error) {
    (void)component, (void)error;
    host->functions->count(host->state, saoms_text("counter.initialized"), 1);
#ifdef HANGS
    for (;;) {
        sleep(1);
    }
#endif
#ifdef MOTOR
    SaomsStopView view = {sizeof view, NULL, motor_stop, NULL, motor_release};
    return host->functions->register_stop(host->state, &view, error);
#endif
#ifdef STUMBLES
    return saoms_fail(error, "this build cannot initialize");
#endif
    return SaomsStatus_OK;
}

static SaomsStatus counter_execute(void *component, const SaomsHostHandle *host, SaomsSink error) {
    Counter *counter = component;
    (void)error;
    counter->count++;
#ifdef FAILS_AT
    if (counter->count == FAILS_AT) {
        return saoms_fail(error, "this build fails");
    }
#endif
    saoms_log(host, SAOMS_INFO, "build %d counts %llu", BUILD, (unsigned long long)counter->count);
    return SaomsStatus_OK;
}

static SaomsStatus counter_shutdown(void *component, const SaomsHostHandle *host, SaomsSink error) {
    (void)component, (void)error;
    saoms_log(host, SAOMS_INFO, "build %d ends", BUILD);
    return SaomsStatus_OK;
}

static SaomsStatus counter_serve(void *component, const SaomsHostHandle *host, SaomsBytes service, uint32_t operation,
                                 SaomsBytes arguments, SaomsSink reply, SaomsSink error) {
    (void)component, (void)host, (void)service, (void)operation, (void)arguments, (void)reply;
    return saoms_fail(error, "it has no services");
}

static void counter_destroy(void *component) {
#ifdef ENDS_SLOWLY
    sleep(1);
#endif
#ifdef HANGS_AT_END
    if (((Counter *)component)->count > 0) {
        for (;;) {
            sleep(1);
        }
    }
#endif
    free(component);
}

#ifndef FORGETS
static SaomsStatus counter_save(void *component, SaomsSink saved, SaomsSink error) {
    SaomsBytes bytes;
    const Counter *counter = component;
    (void)error;
    if (counter->count < 100) {
        return saoms_fail(error, "it has not counted to 100 yet");
    }
    bytes.data = (const uint8_t *)&counter->count;
    bytes.length = sizeof counter->count;
    saved.put(saved.state, bytes);
    return SaomsStatus_OK;
}
#endif

static SaomsStatus counter_restore(void *component, SaomsBytes saved, SaomsSink error) {
    Counter *counter = component;
    if (saved.length != sizeof counter->count) {
        return saoms_fail(error, "the earlier build saved something else");
    }
    memcpy(&counter->count, saved.data, sizeof counter->count);
    return SaomsStatus_OK;
}

SAOMS_METADATA static const char metadata[] =
    "{\"saoms\":\"plugin\",\"abi\":3,\"package\":\"counter\",\"version\":\"0.1.0\",\"entry\":\"counter_plugin\",\"classes\":"
    "[{\"contract\":1,\"class\":\"test.Counter\",\"kind\":\"periodic\",\"stops\":" STOPS ",\"doc\":\"" DOC "\",\"properties\":[],"
    "\"publishes\":[],\"subscribes\":[],\"services\":[],\"references\":[]}]}";

SAOMS_EXPORT const SaomsPluginTable *counter_plugin(uint32_t version) {
    static SaomsComponentTable component;
    static SaomsClassTable class_table;
    static const SaomsClassTable *const classes[] = {&class_table};
    static SaomsPluginTable table;
    (void)version;
    component.size = sizeof component;
    component.initialize = counter_initialize;
    component.execute = counter_execute;
    component.shutdown = counter_shutdown;
    component.serve = counter_serve;
    component.destroy = counter_destroy;
#ifndef FORGETS
    component.save = counter_save;
#endif
    component.restore = counter_restore;
    class_table.size = sizeof class_table;
    class_table.construct = counter_construct;
    class_table.component = &component;
    table.size = sizeof table;
    table.version = SAOMS_ABI_VERSION;
    table.metadata = saoms_text(metadata);
    table.classes = classes;
    table.class_count = 1;
    return &table;
}
