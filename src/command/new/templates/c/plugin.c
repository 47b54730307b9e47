/* A component that counts, and publishes its count on a topic of its own. */

#include "saoms_author.h"

#define JSON(...) #__VA_ARGS__

/* The message of the topic; its fields in this order. */
#define COUNT JSON({"name": "Count", "fields": [{"name": "number", "type": "uint64"}]})

typedef struct Counter {
    uint64_t step, number;
    uint32_t publisher;
} Counter;

/* Makes one from the values of a composite. The checker makes components that never run, so it does nothing else. */
static SaomsStatus construct(const SaomsPropertyView *values, size_t count, void **made, SaomsFindingSink findings,
                             SaomsSink error) {
    Counter *counter = calloc(1, sizeof *counter);
    (void)findings;
    if (counter == NULL) {
        return saoms_fail(error, "there is no memory left");
    }
    counter->step = (uint64_t)saoms_property_number(values, count, "step", 1);
    *made = counter;
    return SaomsStatus_OK;
}

static SaomsStatus initialize(void *component, const SaomsHostHandle *host, SaomsSink error) {
    Counter *counter = component;
    /* 0: a topic of state, which keeps the newest message. */
    SaomsTopicView topic = {saoms_text("COUNT"), saoms_text("Count"), saoms_text(COUNT), 0};
    return host->functions->publish(host->state, &topic, &counter->publisher, error);
}

static SaomsStatus execute(void *component, const SaomsHostHandle *host, SaomsSink error) {
    Counter *counter = component;
    uint8_t memory[64];
    SaomsBuffer message = saoms_writer(memory, sizeof memory);
    counter->number += counter->step;
    saoms_log(host, SAOMS_INFO, "counts to %llu", (unsigned long long)counter->number);
    saoms_write_u64(&message, counter->number);
    return host->functions->send(host->state, counter->publisher, NULL, saoms_written(&message), error);
}

static SaomsStatus shutdown(void *component, const SaomsHostHandle *host, SaomsSink error) {
    (void)component, (void)host, (void)error;
    return SaomsStatus_OK;
}

static SaomsStatus serve(void *component, const SaomsHostHandle *host, SaomsBytes service, uint32_t operation,
                         SaomsBytes arguments, SaomsSink reply, SaomsSink error) {
    (void)component, (void)host, (void)service, (void)operation, (void)arguments, (void)reply;
    error.put(error.state, saoms_text("there is no such operation"));
    return SaomsStatus_MISMATCH;
}

static void destroy(void *component) { free(component); }

/* What the library says about itself, before anything in it runs. */
#define TOPICS JSON([{"topic": "COUNT", "kind": "state", "message": "Count", "schema":) COUNT JSON(}])

SAOMS_METADATA static const char metadata[] =
    JSON({"saoms": "plugin", "abi": ABI_NUMBER, "package": "my-plugin", "version": "0.1.0", "entry": "saoms_plugin_my_plugin", "classes": [
        {"contract": 1, "class": "my_plugin.MyPlugin", "kind": "periodic", "doc": "A component that counts.",
         "properties": [{"name": "step", "type": "integer", "doc": "Number that is added in each period.", "min": 1,
                         "max": 100, "default": "1"}],
         "publishes":) TOPICS JSON(}]});

/* Members by their names: what a later header has more stays null. */
static const SaomsComponentTable component_table = {
    .size = sizeof(SaomsComponentTable), .initialize = initialize, .execute = execute,
    .shutdown = shutdown, .serve = serve, .destroy = destroy,
};

static const SaomsClassTable class_table = {
    .size = sizeof(SaomsClassTable), .construct = construct, .component = &component_table,
};

static const SaomsClassTable *const classes[] = {&class_table};

SAOMS_EXPORT const SaomsPluginTable *saoms_plugin_my_plugin(uint32_t version) {
    static SaomsPluginTable table = {.size = sizeof table, .version = SAOMS_ABI_VERSION, .classes = classes, .class_count = 1};
    (void)version;
    table.metadata = saoms_text(metadata);
    return &table;
}
