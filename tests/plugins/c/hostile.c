/* Components in C that do to the process, or ask of the program, what they must not, by the property `does`. */
/* For `dladdr`. */
#define _GNU_SOURCE
#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "process.h"
#include "saoms_author.h"

#define JSON(...) #__VA_ARGS__
/* The same with macros in it expanded. */
#define TEXT(...) JSON(__VA_ARGS__)
#define WORD JSON({"name": "Word", "fields": [{"name": "text", "type": "string"}]})

#ifndef KEY
#define KEY "number"
#endif
#ifndef PLACE
#define PLACE "spot"
#endif
/* The interface of the service and of the reference. */
#ifndef INTERFACE
#define INTERFACE "h.Callee"
#endif
/* Members of the declaration of `h.Motor`, and whether its property is live. */
#ifndef SAYS
#define SAYS
#endif
#ifndef LIVE
#define LIVE false
#endif
#define SPOTTED JSON({"name": "Spotted", "fields": [{"name": "number", "type": "uint32"}, {"name": "spot", "type": {"name": "Spot", "fields": [{"name": "x", "type": "int32"}, {"name": "y", "type": "int32"}]}}], "key":) TEXT(KEY) JSON(, "place":) TEXT(PLACE) JSON(})

typedef struct Actor {
    char does[48];
    uint32_t words, hears, spots, sees, callee, executions;
} Actor;

static volatile int *volatile nowhere = NULL;
/* What the destructor of the library does. */
static const char *volatile at_end = "";

static int does(const Actor *actor, const char *what) { return strcmp(actor->does, what) == 0; }

static void end(void) {
    if (strcmp(at_end, "exits") == 0) {
        _exit(0);
    } else if (strcmp(at_end, "crashes") == 0) {
        *nowhere = 1;
    } else if (strcmp(at_end, "hangs") == 0) {
        for (;;) {
            sleep(1);
        }
    }
}

/* What is done to the process while the library is loaded. */
#ifndef LOADS
#define LOADS ""
#endif
#ifndef ENTERS
#define ENTERS ""
#endif
__attribute__((constructor)) static void load(void) { act_on_process(LOADS); }
__attribute__((destructor)) static void unload(void) { end(); }

static SaomsStatus construct(const SaomsPropertyView *values, size_t count, void **made, SaomsFindingSink findings,
                             SaomsSink error) {
    Actor *actor = calloc(1, sizeof *actor);
    saoms_property_text(values, count, "does", actor->does, sizeof actor->does);
    if (does(actor, "goes elsewhere") && chdir("/") != 0) {
        return saoms_fail(error, "there is no other folder");
    }
    if (strncmp(actor->does, "made: ", 6) == 0) {
        act_on_process(actor->does + 6);
    }
    if (does(actor, "finds without end")) {
        uint32_t count;
        for (count = 0; count < 100000; count++) {
            saoms_refuse(findings, error, "does", "again");
        }
        return SaomsStatus_FAILED;
    }
    if (does(actor, "finds something and goes on")) {
        saoms_refuse(findings, error, "does", "is not what a component does");
    }
    *made = actor;
    return SaomsStatus_OK;
}

static SaomsStatus stop(void *state, SaomsSink error) {
    (void)error;
    fprintf(stderr, "the hardware stops\n");
    if (strcmp(state, "crashes in stop") == 0) {
        *nowhere = 1;
    }
    while (strstr(state, "hangs in stop") != NULL) {
        sleep(1);
    }
    return SaomsStatus_OK;
}

/* The state of a motor is a text that outlives the component. */
static void release(void *state) {
    if (strcmp(state, "hangs in release") == 0) {
        for (;;) {
            sleep(1);
        }
    }
}

static SaomsStatus beat(void *state, uint64_t period, SaomsSink error) {
    (void)state, (void)period;
    return saoms_fail(error, "the line is dead");
}

static SaomsStatus register_stops(Actor *actor, const SaomsHostHandle *host, SaomsSink error) {
    SaomsStopView view = {sizeof view, strdup(actor->does), stop, NULL, release};
    uint32_t count = does(actor, "registers without end") ? 1000000 : 1;
    SaomsStatus status = SaomsStatus_OK;
    if (does(actor, "fails to beat")) {
        view.heartbeat = beat;
    }
    if (does(actor, "a short view")) {
        view.size = offsetof(SaomsStopView, release) + 4;
    }
    while (status == SaomsStatus_OK && count-- > 0) {
        status = host->functions->register_stop(host->state, &view, error);
    }
    return status;
}

static SaomsStatus initialize(void *component, const SaomsHostHandle *host, SaomsSink error) {
    Actor *actor = component;
    const SaomsHostFunctions *functions = host->functions;
    SaomsTopicView words = {saoms_text("WORDS"), saoms_text("Word"), saoms_text(WORD), 1};
    SaomsTopicView spots = {saoms_text("SPOTS"), saoms_text("Spotted"), saoms_text(SPOTTED), 0};
    uint32_t count = does(actor, "subscribes without end") ? 1000000 : 1;
    if (strncmp(actor->does, "begins: ", 8) == 0) {
        act_on_process(actor->does + 8);
    } else if (does(actor, "jumps to an earlier call")) {
        act_on_process("marks a place");
    } else if (does(actor, "continues a part")) {
        act_on_process("begins a part");
    }
    SaomsStatus status;
    if (does(actor, "another schema")) {
        words.schema = saoms_text(SPOTTED);
    } else if (does(actor, "another kind")) {
        words.kind = 0;
    }
    status = functions->publish(host->state, &words, &actor->words, error);
    if (status == SaomsStatus_OK) {
        status = functions->publish(host->state, &spots, &actor->spots, error);
    }
    while (status == SaomsStatus_OK && count-- > 0) {
        status = functions->subscribe(host->state, &words, &actor->hears, error);
    }
    if (status == SaomsStatus_OK) {
        status = functions->subscribe(host->state, &spots, &actor->sees, error);
    }
    if (status == SaomsStatus_OK) {
        status = functions->reference(host->state, saoms_text("callee"), saoms_text(INTERFACE), &actor->callee, error);
    }
    return status;
}

static SaomsStatus initialize_motor(void *component, const SaomsHostHandle *host, SaomsSink error) {
    SaomsStatus status = register_stops(component, host, error);
    return status == SaomsStatus_OK ? initialize(component, host, error) : status;
}

static void *crash(void *nothing) {
    (void)nothing;
    *nowhere = 1;
    return NULL;
}

static void leave(void *state, SaomsBytes bytes) {
    (void)state, (void)bytes;
    longjmp(earlier, 1);
}

static void nothing(void *state, SaomsBytes bytes) { (void)state, (void)bytes; }

/* Wide regions, from which one differs from the other, over all that is there. */
static SaomsStatus move_region(Actor *actor, const SaomsHostHandle *host, SaomsSink error) {
    SaomsStatus status = SaomsStatus_OK;
    int32_t move;
    for (move = 0; status == SaomsStatus_OK && move < 1000; move++) {
        SaomsRegionView region = {{INT32_MIN, INT32_MIN}, {INT32_MAX - move % 2, INT32_MAX}};
        status = host->functions->set_region(host->state, actor->sees, &region, error);
    }
    return status;
}

static const char *long_text(void) {
    static char text[30001];
    memset(text, 'x', sizeof text - 1);
    return text;
}

static SaomsStatus send_spot(Actor *actor, const SaomsHostHandle *host, uint32_t topic, uint32_t number, uint64_t key,
                             SaomsSink error) {
    uint8_t bytes[64];
    SaomsBuffer writer = saoms_writer(bytes, sizeof bytes);
    (void)actor;
    saoms_write_u32(&writer, number);
    saoms_write_i32(&writer, 1);
    saoms_write_i32(&writer, 1);
    return host->functions->send(host->state, topic, &key, saoms_written(&writer), error);
}

static SaomsStatus send_word(Actor *actor, const SaomsHostHandle *host, SaomsSink error) {
    uint8_t bytes[64];
    uint64_t key = 3;
    SaomsBuffer writer = saoms_writer(bytes, sizeof bytes);
    saoms_write_string(&writer, "word");
    return host->functions->send(host->state, actor->words, &key, saoms_written(&writer), error);
}

static SaomsStatus publish_keys(Actor *actor, const SaomsHostHandle *host, uint32_t count, SaomsSink error) {
    SaomsStatus status = SaomsStatus_OK;
    uint32_t key;
    for (key = 0; status == SaomsStatus_OK && key < count; key++) {
        status = send_spot(actor, host, actor->spots, key, key, error);
    }
    return status;
}

/* More than one execution may write, whatever it answers. */
static SaomsStatus write_without_end(Actor *actor, const SaomsHostHandle *host) {
    SaomsRecordView record = {.text = saoms_text("stays")};
    uint32_t count;
    for (count = 0; count < 200000; count++) {
        if (does(actor, "records without end")) {
            host->functions->journal(host->state, 0, &record);
        } else if (does(actor, "names loops without end")) {
            host->functions->name_loop(host->state, 1, saoms_text("loop"));
        } else {
            host->functions->log(host->state, SAOMS_DEBUG, saoms_text("line"));
        }
    }
    return does(actor, "records without end") ? SaomsStatus_BUSY : SaomsStatus_OK;
}

static SaomsStatus execute(void *component, const SaomsHostHandle *host, SaomsSink error) {
    Actor *actor = component;
    const SaomsHostFunctions *functions = host->functions;
    SaomsSink reply = {NULL, nothing};
    SaomsRegionView region = {{0, 0}, {1, 1}};
    SaomsBytes null = {NULL, 10};
    if (actor->executions++ != 2) {
        return SaomsStatus_OK;
    }
    if (strncmp(actor->does, "hangs in stop, ", 15) == 0) {
        act_on_process(actor->does + 15);
    }
    act_on_process(actor->does);
    if (does(actor, "reports deep")) {
        static char path[200001];
        memset(path, '.', sizeof path - 1);
        functions->count(host->state, saoms_text(path), 1);
        saoms_log(host, SAOMS_INFO, "has reported");
    } else if (does(actor, "reports at length")) {
        functions->count(host->state, saoms_text(long_text()), 1);
        functions->count(host->state, saoms_text(long_text()), 1);
    } else if (does(actor, "logs at length")) {
        functions->log(host->state, SAOMS_WARNING, saoms_text(long_text()));
    } else if (does(actor, "logs what is not there")) {
        functions->log(host->state, SAOMS_ERROR, null);
    } else if (does(actor, "fails at length")) {
        return saoms_fail(error, long_text());
    } else if (strstr(actor->does, "s without end") != NULL && !does(actor, "keys without end")) {
        return write_without_end(actor, host);
    } else if (does(actor, "is busy with nobody")) {
        return SaomsStatus_BUSY;
    } else if (does(actor, "counts down and fails")) {
        functions->count(host->state, saoms_text("h.count"), INT64_MIN);
        return saoms_fail(error, "has counted");
    } else if (does(actor, "calls")) {
        /* As a component in C passes a failed call on. */
        return functions->call(host->state, actor->callee, 0, saoms_text(""), reply, error);
    } else if (does(actor, "calls and is left")) {
        if (setjmp(earlier) == 0) {
            return functions->call(host->state, actor->callee, 0, saoms_text(""), reply, error);
        }
        fprintf(stderr, "is left by the component that it called\n");
    } else if (does(actor, "leaves a reply")) {
        SaomsSink left = {NULL, leave};
        if (setjmp(earlier) == 0) {
            return functions->call(host->state, actor->callee, 0, saoms_text(""), left, error);
        }
    } else if (does(actor, "keeps null")) {
        return functions->keep(host->state, 1, null, error);
    } else if (does(actor, "a region without a block")) {
        return functions->set_region(host->state, actor->hears, &region, error);
    } else if (does(actor, "a region of nobody")) {
        return functions->set_region(host->state, 77, &region, error);
    } else if (does(actor, "keys without end")) {
        return publish_keys(actor, host, 100500, error);
    } else if (does(actor, "a foreign key")) {
        return send_spot(actor, host, actor->spots, 7, 9, error);
    } else if (does(actor, "a key of no message")) {
        return send_word(actor, host, error);
    } else if (does(actor, "moves a region")) {
        return move_region(actor, host, error);
    } else if (does(actor, "crashes on a thread")) {
        pthread_t thread;
        if (pthread_create(&thread, NULL, crash, NULL) == 0) {
            pthread_join(thread, NULL);
        }
    } else if (does(actor, "takes signals")) {
        signal(SIGINT, SIG_IGN);
        signal(SIGTERM, SIG_IGN);
    } else if (does(actor, "traps")) {
        raise(SIGTRAP);
    } else if (strncmp(actor->does, "at the end ", 11) == 0) {
        at_end = strdup(actor->does + 11);
        atexit(end);
        return saoms_fail(error, "fails before");
    }
    return SaomsStatus_OK;
}

static SaomsStatus shutdown(void *component, const SaomsHostHandle *host, SaomsSink error) {
    (void)component, (void)host, (void)error;
    return SaomsStatus_OK;
}

static SaomsStatus serve(void *component, const SaomsHostHandle *host, SaomsBytes service, uint32_t operation,
                         SaomsBytes arguments, SaomsSink reply, SaomsSink error) {
    (void)host, (void)service, (void)operation, (void)arguments, (void)reply;
    if (does(component, "leaves its caller")) {
        longjmp(earlier, 1);
    } else if (does(component, "replies")) {
        static const uint8_t four[] = {4, 0, 0, 0};
        SaomsBytes bytes = {four, sizeof four};
        reply.put(reply.state, bytes);
        return SaomsStatus_OK;
    }
    return saoms_fail(error, "serves nobody");
}

static void destroy(void *component) {
    if (does(component, "finds something and goes on")) {
        fprintf(stderr, "what found something is destroyed\n");
    }
    free(component);
}

static SaomsStatus save(void *component, SaomsSink saved, SaomsSink error) {
    (void)component, (void)saved, (void)error;
    return SaomsStatus_OK;
}

static SaomsStatus restore(void *component, SaomsBytes saved, SaomsSink error) {
    (void)component, (void)saved, (void)error;
    return SaomsStatus_OK;
}

#define TOPICS JSON([{"topic": "WORDS", "kind": "event", "message": "Word", "optional": true, "schema":) WORD JSON(}, {"topic": "SPOTS", "kind": "state", "message": "Spotted", "optional": true, "schema":) SPOTTED JSON(}])
#define CALLEE JSON({"name": "callee", "optional": true, "interface": {"name":) TEXT(INTERFACE) JSON(, "operations": [{"name": "call", "arguments": [], "reply": "uint32"}]}})
#define MEMBERS JSON("kind": "periodic", "properties": [{"name": "does", "type": "string", "default": "", "live":) TEXT(LIVE) JSON(}], "services": [) CALLEE JSON(], "references": [) CALLEE JSON(], "publishes":) TOPICS JSON(, "subscribes":) TOPICS

SAOMS_METADATA static const char metadata[] =
    JSON({"saoms": "plugin", "abi":) TEXT(SAOMS_ABI_VERSION) JSON(, "package": "hostile", "version": "0.1.0", "entry": "hostile_plugin", "classes": [
        {"contract": 1, "class": "h.Actor",) MEMBERS JSON(}, {"contract": 1, "class": "h.Motor", "stops": true,) TEXT(SAYS) MEMBERS JSON(}, {"contract": 1, "class": "h.Saver", "saves": true,) MEMBERS JSON(}]});

static const SaomsComponentTable actor_table = {
    .size = sizeof actor_table, .initialize = initialize, .execute = execute,
    .shutdown = shutdown, .serve = serve, .destroy = destroy,
};

static const SaomsComponentTable motor_table = {
    .size = sizeof motor_table, .initialize = initialize_motor, .execute = execute,
    .shutdown = shutdown, .serve = serve, .destroy = destroy,
};

static const SaomsComponentTable saver_table = {
    .size = sizeof saver_table, .initialize = initialize, .execute = execute, .shutdown = shutdown,
    .serve = serve, .destroy = destroy, .save = save, .restore = restore,
};

static const SaomsClassTable actors = {.size = sizeof actors, .construct = construct, .component = &actor_table};
static const SaomsClassTable motors = {.size = sizeof motors, .construct = construct, .component = &motor_table};
static const SaomsClassTable savers = {.size = sizeof savers, .construct = construct, .component = &saver_table};

SAOMS_EXPORT const SaomsPluginTable *hostile_plugin(uint32_t version) {
    static const SaomsClassTable *classes[] = {&actors, &motors, &savers};
    static SaomsPluginTable table = {.size = sizeof table, .version = SAOMS_ABI_VERSION, .classes = classes, .class_count = 3};
    (void)version;
    act_on_process(ENTERS);
    table.metadata = saoms_text(metadata);
    return &table;
}
